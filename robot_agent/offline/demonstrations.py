"""Drives a simulated robot under a simulated tracker, tick by tick, and notes where it really was."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseEstimator
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.geometry import Compartment, Grid, Move, Pose
from swarm.tracker_noise import measured

FIX_LATE_TICKS = 2
"""As in a run with one tick an exchange: a pose arrives two exchanges after it was true."""
FIRST_REST_S = (4.0, 4.5)
"""Long enough for an observer that looks the wrong way to find the demonstrator before it moves."""
REST_S = (1.5, 2.0)
"""From the experiment file's `rest_s` up: a person or a process may add half a second."""
MOST_TICKS_A_MOVE = 600
"""A minute: a move takes 2.4 s, so that a robot that is not there by then never will be."""


@dataclass(frozen=True)
class Demonstration:
    """The moves that a robot made from a rest to a rest, and its true pose at every tick."""

    start: int
    moves: tuple[Move, ...]
    track: tuple[Pose, ...]
    middles: tuple[float, ...]
    """The tick in the middle of each move."""


class TrackedRobot:
    """A body and its estimate of its own pose, from wheel steps and late, noisy, gappy fixes."""

    def __init__(self, experiment: Experiment, pose: Pose, walls: Compartment, rng: np.random.Generator):
        faults, geometry = experiment.body, EpuckGeometry()
        body_rng, self._rng = rng.spawn(2)
        self.body = SimulatedBody(
            geometry,
            BodyFaults(faults.slip_sd, faults.gain_error_sd, faults.latency_s),
            pose,
            walls,
            body_rng,
        )
        self._estimator = PoseEstimator(geometry)
        self._tracker = experiment.tracker
        self._under_way: deque[tuple[Pose, int] | None] = deque([None] * FIX_LATE_TICKS)

    def observe(self, t_ns: int) -> Pose | None:
        """What the robot believes at this tick; call it once a tick."""
        self._estimator.odometry(self.body.wheel_steps(t_ns), t_ns)
        self._under_way.append(self._measured(t_ns))
        if fix := self._under_way.popleft():
            self._estimator.fix(*fix)
        return self.pose_at(t_ns)

    def pose_at(self, t_ns: int) -> Pose | None:
        """What the robot believes now of where it was then."""
        return self._estimator.pose(t_ns)

    @property
    def displaced(self) -> bool:
        """Whether the tracker says that somebody carried or pushed the robot since it was last asked."""
        displaced = self._estimator.displaced
        if displaced:
            self._estimator.reset()
        return displaced

    def pose_age_s(self, t_ns: int) -> float:
        return self._estimator.age_s(t_ns)

    def _measured(self, t_ns: int) -> tuple[Pose, int] | None:
        """The noisy truth of this tick, or None if the tracker missed it."""
        noise, loss = self._rng.standard_normal(3).tolist(), self._rng.random()
        pose = measured(self.body.truth(t_ns), self._tracker, noise, loss)
        return (pose, t_ns) if pose else None


def demonstrate(
    experiment: Experiment, start: int, moves: Sequence[Move], rng: np.random.Generator
) -> Demonstration:
    """Rest, drive the moves from a start cell of the first robot's compartment, and rest again."""
    walls = experiment.compartment(experiment.robot[0])
    heading_rad = Move(int(rng.integers(len(Move)))).theta_rad
    driver = _Driver(experiment, Pose(*walls.centre(start), heading_rad), walls, rng)
    driver.stop(rng.uniform(*FIRST_REST_S))
    state, middles = start, []
    for move in moves:
        entered = walls.grid.neighbour(state, move)
        if entered is None:
            raise ValueError(f"{move.name} leaves the grid from state {state}; choose another start")
        began = len(driver.track)
        driver.go_to(*walls.centre(entered))
        middles.append((began + len(driver.track)) / 2)
        state = entered
    driver.stop(rng.uniform(*REST_S))
    return Demonstration(start, tuple(moves), tuple(driver.track), tuple(middles))


class _Driver:
    """A robot under its motion controller."""

    def __init__(self, experiment: Experiment, pose: Pose, walls: Compartment, rng: np.random.Generator):
        self.track: list[Pose] = []
        self._tick_s = experiment.simulation.tick_s
        self._robot = TrackedRobot(experiment, pose, walls, rng)
        self._motion = Motion(MotionSettings(period_s=self._tick_s), EpuckGeometry())

    def stop(self, duration_s: float) -> None:
        for _ in range(round(duration_s / self._tick_s)):
            self._tick()

    def go_to(self, x_m: float, y_m: float) -> None:
        self._motion.go_to(x_m, y_m)
        for _ in range(MOST_TICKS_A_MOVE):
            self._tick()
            if self._motion.arrived:
                return
        raise RuntimeError(f"the robot has not reached ({x_m}, {y_m}) in {MOST_TICKS_A_MOVE} ticks")

    def _tick(self) -> WheelSpeeds:
        t_ns = round((len(self.track) + 1) * self._tick_s * NS_PER_S)
        estimate = self._robot.observe(t_ns)
        self.track.append(self._robot.body.truth(t_ns))
        speeds = self._motion.step(estimate, t_ns, self._robot.pose_age_s(t_ns))
        return self._robot.body.drive(speeds, t_ns)


def random_moves(rng: np.random.Generator, grid: Grid, count: int) -> tuple[int, tuple[Move, ...]]:
    """A start cell and moves that stay inside the grid and out of the goal cell."""
    start = state = int(rng.integers(grid.goal))
    moves: list[Move] = []
    while len(moves) < count:
        move = Move(int(rng.integers(len(Move))))
        entered = grid.neighbour(state, move)
        if entered is not None and entered != grid.goal:
            moves.append(move)
            state = entered
    return start, tuple(moves)


def expert_moves(rng: np.random.Generator, grid: Grid, count: int) -> tuple[int, tuple[Move, ...]]:
    """Consecutive moves at a random place of the expert's track, the diagonal of a square grid."""
    first = int(rng.integers(min(grid.columns, grid.rows) - count))
    return grid.state(first, first), (Move.SE,) * count
