"""One robot that drives under a late, noisy, gappy tracker: what the motion test and benchmark share."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseEstimator
from swarm.geometry import Compartment, Grid, Move, Pose

TICK_NS = 100_000_000
COMPARTMENT = Compartment(0.0, 0.0, Grid(10, 10), 0.12)


@dataclass(frozen=True)
class TrackerFaults:
    """What a tracker at 10 Hz does to the truth."""

    position_sd_m: float = 0.001
    heading_sd_rad: float = math.radians(0.5)
    latency_s: tuple[float, float] = (0.06, 0.10)
    missing: float = 0.02
    """Part of the single fixes that never come."""

    losses_per_s: float = 1 / 60
    loss_s: float = 3.0
    early_s: float = 0.0
    """How long before the robot's tick the tracker measures."""


class Tracker:
    """Measures a body's truth and hands the fixes over late."""

    def __init__(self, faults: TrackerFaults, rng: np.random.Generator) -> None:
        self._faults = faults
        self._rng = rng
        self._under_way: deque[tuple[int, Pose, int]] = deque()
        self._lost_until_ns = 0

    def fixes(self, truth: Callable[[int], Pose], tick_ns: int) -> list[tuple[Pose, int]]:
        """Measure once; return the fixes that have arrived by now, with the times of their measurement."""
        self._measure(truth, tick_ns - round(self._faults.early_s * 1e9))
        arrived = []
        while self._under_way and self._under_way[0][0] <= tick_ns:
            _, pose, t_ns = self._under_way.popleft()
            arrived.append((pose, t_ns))
        return arrived

    def _measure(self, truth: Callable[[int], Pose], t_ns: int) -> None:
        faults, rng = self._faults, self._rng
        pose = truth(t_ns)
        if t_ns >= self._lost_until_ns and rng.random() < faults.losses_per_s * TICK_NS * 1e-9:
            self._lost_until_ns = t_ns + round(faults.loss_s * 1e9)
        if t_ns < self._lost_until_ns or rng.random() < faults.missing:
            return
        dx_m, dy_m = rng.normal(0.0, faults.position_sd_m, 2).tolist()
        measured = Pose(
            pose.x_m + dx_m, pose.y_m + dy_m, pose.theta_rad + rng.normal(0.0, faults.heading_sd_rad)
        )
        self._under_way.append((t_ns + round(rng.uniform(*faults.latency_s) * 1e9), measured, t_ns))


class MovingRobot:
    """Body, estimator, motion and tracker, ticked together at 10 Hz."""

    def __init__(
        self,
        seed: int,
        body_faults: BodyFaults | None = None,
        tracker_faults: TrackerFaults | None = None,
        settings: MotionSettings | None = None,
    ) -> None:
        body_rng, tracker_rng = np.random.default_rng(seed).spawn(2)
        geometry = EpuckGeometry()
        start = Pose(*COMPARTMENT.centre(COMPARTMENT.grid.start), 0.0)
        self.body = SimulatedBody(geometry, body_faults or BodyFaults(), start, COMPARTMENT, body_rng)
        self.estimator = PoseEstimator(geometry)
        self.motion = Motion(settings or MotionSettings(), geometry)
        self.tracker = Tracker(tracker_faults or TrackerFaults(), tracker_rng)
        self.t_ns = TICK_NS
        self.stalled_ticks = 0

    def tick(self) -> WheelSpeeds:
        """One control period: observe, then act. Returns the wheel speeds sent."""
        fixes = self.tracker.fixes(self.body.truth, self.t_ns)
        self.estimator.odometry(self.body.wheel_steps(self.t_ns), self.t_ns)
        for pose, t_ns in fixes:
            self.estimator.fix(pose, t_ns)
        estimate, age_s = self.estimator.pose(self.t_ns), self.estimator.age_s(self.t_ns)
        sent = self.body.drive(self.motion.step(estimate, self.t_ns, age_s), self.t_ns)
        self.stalled_ticks += self.motion.stalled
        self.t_ns += TICK_NS
        return sent

    def drive_to(self, x_m: float, y_m: float, ticks: int = 1000) -> tuple[float, float]:
        """Go to a place; return how long it took (s) and how far off the robot stands (m).

        The time goes to the tick in which the agent can start its next move. Raises RuntimeError if the
        robot has not arrived after so many ticks.
        """
        self.motion.go_to(x_m, y_m)
        for count in range(1, ticks + 1):
            self.tick()
            if self.motion.arrived:
                stands = self.body.truth(self.t_ns - TICK_NS)
                return count * TICK_NS * 1e-9, math.hypot(stands.x_m - x_m, stands.y_m - y_m)
        raise RuntimeError(f"the robot has not reached ({x_m}, {y_m}) in {ticks} ticks")


@dataclass(frozen=True)
class MoveFigures:
    """What a series of moves showed."""

    mean_s: float
    mean_error_cm: float
    p99_error_cm: float
    worst_error_cm: float
    contacts: int
    stalled: float
    """Part of the time spent waiting for a fix."""


def random_moves(robot: MovingRobot, moves: int, rng: np.random.Generator) -> MoveFigures:
    """Drive random legal compass moves from cell to cell."""
    grid, state = COMPARTMENT.grid, COMPARTMENT.grid.start
    durations_s, errors_m = [], []
    for _ in range(moves):
        legal = [next_state for move in Move if (next_state := grid.neighbour(state, move)) is not None]
        state = legal[int(rng.integers(len(legal)))]
        duration_s, error_m = robot.drive_to(*COMPARTMENT.centre(state))
        durations_s.append(duration_s)
        errors_m.append(error_m)
    errors_cm = 100.0 * np.array(errors_m)
    return MoveFigures(
        float(np.mean(durations_s)),
        float(errors_cm.mean()),
        float(np.quantile(errors_cm, 0.99)),
        float(errors_cm.max()),
        robot.body.contacts,
        robot.stalled_ticks * TICK_NS * 1e-9 / sum(durations_s),
    )
