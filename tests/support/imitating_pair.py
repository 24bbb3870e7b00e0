"""Two robots behind links: one drives a pattern, the other sees it in rendered frames and drives it too."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.drivers.sim.camera import BUILT_IN_MODEL, calibration_frames_of
from robot_agent.drivers.sim.rendering.camera import SceneCamera, SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Rectangle, Scene, SceneRobot
from robot_agent.imitation.copying import NoCopy
from robot_agent.imitation.imitation import Imitation, imitate_pattern, stand
from robot_agent.imitation.observer import Watch
from robot_agent.imitation.pattern import Place
from robot_agent.imitation.replication import Arrival, Command, Drive, Turn, replicate
from robot_agent.navigation.located_robot import LocatedRobot
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseEstimator
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.detector import Detector, at_profile
from swarm.clock import NS_PER_S
from swarm.config.experiment import CopyProfile, TrackerSettings
from swarm.geometry import Compartment, Grid, Pose, wrap_angle_rad
from swarm.tracker_noise import measured
from tests.support.emulated_robot import EmulatedRig

TICK_NS = NS_PER_S // 10
FRAMES_PER_S = 5.0
WATCH_S = 40.0
HALL = Compartment(0.0, 0.0, Grid(100, 100), 0.12)
ROOM = Rectangle(5.4, 5.4, 6.6, 6.6)
"""The walls that the observer sees: a compartment of the paper's size."""
OBSERVERS_PLACE = Pose(6.65, 5.35, 0.75 * math.pi)


Showing = Generator[None, int, list[Arrival]]
Watching = Generator[None, int, Imitation | NoCopy]


@dataclass(frozen=True)
class Imitated:
    """What the observer made of a pattern, and where both robots really were at its corners."""

    result: Imitation | NoCopy
    shown: list[Place]
    driven: list[Place]


class PlacedRobot:
    """A robot somewhere in the hall, behind a link or simulated, under a simulated tracker or without one."""

    def __init__(
        self, link: str, place: Path, pose: Pose, rng: np.random.Generator, *, tracked: bool = True
    ) -> None:
        self.geometry = EpuckGeometry()
        self._tracker_rng = rng
        self._tracker = TrackerSettings()
        self._rig = None if link == "sim" else _rig(link, place, pose)
        self._sim = SimulatedBody(self.geometry, BodyFaults(), pose, HALL, rng) if link == "sim" else None
        self._fixes: list[tuple[Pose, int]] = []
        body = self._rig.body if self._rig else self._sim
        assert body is not None
        fixes = self._take if tracked else None
        self.located = LocatedRobot(body, PoseEstimator(self.geometry), fixes)
        self.motion = Motion(MotionSettings(), self.geometry)

    def truth(self, t_ns: int) -> Pose:
        if self._rig:
            with self._rig.emulation.lock:
                return self._rig.emulation.robot.truth(t_ns)
        assert self._sim
        return self._sim.truth(t_ns)

    def pass_time(self, t_ns: int) -> None:
        """Let the world's time pass, and the tracker measure; its pose arrives at the next tick."""
        if self._rig:
            self._rig.run_to(t_ns)
        noise = self._tracker_rng.standard_normal(3).tolist()
        seen = measured(self.truth(t_ns), self._tracker, noise, self._tracker_rng.random())
        self._fixes += [(seen, t_ns)] if seen else []

    def close(self) -> None:
        if self._rig:
            self._rig.close()

    def _take(self) -> list[tuple[Pose, int]]:
        fixes, self._fixes = self._fixes[:-1], self._fixes[-1:]
        return fixes


def _rig(link: str, place: Path, pose: Pose) -> EmulatedRig:
    place.mkdir(exist_ok=True)
    name, _, model = link.partition("-")
    rig = EmulatedRig(name, model or "epuck2", place)
    rig.emulation.robot.place(pose)
    return rig


def random_pattern(rng: np.random.Generator, segments: int = 5) -> tuple[tuple[Command, ...], list[Place]]:
    """Commands whose corners stay in the room, from its middle, and those corners."""
    while True:
        commands: list[Command] = []
        corners, heading_rad = [(6.0, 6.0)], 0.0
        for _ in range(segments):
            turn_rad = float(rng.choice([-1, 1]) * rng.uniform(math.radians(30), math.radians(135)))
            length_m = float(rng.uniform(0.15, 0.35))
            heading_rad += turn_rad
            x_m, y_m = corners[-1]
            corners.append((x_m + length_m * math.cos(heading_rad), y_m + length_m * math.sin(heading_rad)))
            commands += [Turn(turn_rad), Drive(length_m)]
        if all(5.5 < value < 6.5 for corner in corners for value in corner):
            return tuple(commands), corners


class ImitatingPair:
    """A demonstrator in the room and an observer at its corner; the tick is a tenth of a second."""

    def __init__(
        self,
        demonstrator: str,
        observer: str,
        place: Path,
        rng: np.random.Generator,
        profile: CopyProfile = CopyProfile.BEST,
        *,
        tracked: bool = True,
    ) -> None:
        robots_rng, self._rng = rng.spawn(2)
        one, other = robots_rng.spawn(2)
        self.demonstrator = PlacedRobot(demonstrator, place / "shows", Pose(6.0, 6.0, 0.0), one)
        self.observer = PlacedRobot(observer, place / "watches", OBSERVERS_PLACE, other, tracked=tracked)
        self._profile = profile
        self._t_ns = NS_PER_S
        self._before: tuple[Pose, Pose] | None = None

    def imitated(self, commands: Sequence[Command]) -> Imitated:
        """Show the commands, have them watched, and see what the observer drives."""
        model = at_profile(self._profile, BUILT_IN_MODEL)
        camera = SceneCamera(SimulatedCamera(model, conditions("realistic"), self._rng), self._look)
        learnt = learn_demonstrator(calibration_frames_of(model, "red", self._rng), model, Skirt("red"))
        detector = Detector(self._profile, model, learnt.demonstrator)

        def begin(t_ns: int) -> Watch:
            pose_at = self.observer.located.pose_at
            return Watch(camera, detector, pose_at, t_ns, WATCH_S, FRAMES_PER_S)

        watching = imitate_pattern(
            self.observer.located, self.observer.motion, self.observer.geometry, begin, self._profile
        )
        return self._together(show(self.demonstrator, commands), watching)

    def _together(self, showing: Showing, watching: Watching) -> Imitated:
        """Tick both until the observer has driven; the demonstrator drives long before."""
        shown: list[Arrival] = []
        truths: dict[int, tuple[Pose, Pose]] = {}
        next(showing), next(watching)
        while True:
            self._t_ns += TICK_NS
            for robot in (self.demonstrator, self.observer):
                robot.pass_time(self._t_ns)
            truths[self._t_ns] = self.demonstrator.truth(self._t_ns), self.observer.truth(self._t_ns)
            try:
                if not shown:
                    showing.send(self._t_ns)
            except StopIteration as ended:
                shown = ended.value
            try:
                watching.send(self._t_ns)
            except StopIteration as ended:
                return _imitated(shown, ended.value, truths)

    def _look(self, t_ns: int) -> tuple[Pose, Scene, float]:
        shown, own = self.demonstrator.truth(t_ns), self.observer.truth(t_ns)
        shown_before, own_before = self._before or (shown, own)
        self._before = shown, own
        velocity = (
            (shown.x_m - shown_before.x_m) * FRAMES_PER_S,
            (shown.y_m - shown_before.y_m) * FRAMES_PER_S,
        )
        turn_rate_rad_s = wrap_angle_rad(own.theta_rad - own_before.theta_rad) * FRAMES_PER_S
        return own, Scene((ROOM,), (SceneRobot(shown, "red", velocity),)), turn_rate_rad_s

    def close(self) -> None:
        self.demonstrator.close()
        self.observer.close()


def show(robot: PlacedRobot, commands: Sequence[Command]) -> Showing:
    """Stand for a while as a demonstrator does, and drive the commands."""
    start = yield from stand(robot.located)
    ends = yield from replicate(robot.located, robot.motion, start.pose, commands)
    return [start, *ends]


def _imitated(
    shown: list[Arrival], result: Imitation | NoCopy, truths: dict[int, tuple[Pose, Pose]]
) -> Imitated:
    driven = [] if isinstance(result, NoCopy) else [result.start, *result.ends]
    return Imitated(
        result,
        [_place(truths[arrival.t_ns][0]) for arrival in shown],
        [_place(truths[arrival.t_ns][1]) for arrival in driven],
    )


def _place(pose: Pose) -> Place:
    return pose.x_m, pose.y_m
