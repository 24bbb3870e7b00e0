"""An observer with its camera in front of demonstrations that were driven before, each with its seed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry
from robot_agent.drivers.sim.camera import BUILT_IN_MODEL, CALIBRATION_RANGES_M
from robot_agent.drivers.sim.rendering.camera import SceneCamera, SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Rectangle, Scene, SceneRobot
from robot_agent.imitation.copying import Copy, NoCopy, copy_moves
from robot_agent.imitation.observer import Watch
from robot_agent.offline.demonstrations import (
    Demonstration,
    TrackedRobot,
    demonstrate,
    expert_moves,
    random_moves,
)
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.detector import Detector, at_profile
from swarm.clock import NS_PER_S
from swarm.config.experiment import CopyProfile, Experiment, RobotSettings, Role, RunSettings
from swarm.geometry import Grid, Move, Pose, wrap_angle_rad
from swarm.learning.random import spawned_generator

SETTLE_TICKS = 20
"""The observer stands for so long before it watches, as in a run, and knows its heading by then."""


def offline_experiment(profile: CopyProfile = CopyProfile.BEST, light: str = "realistic") -> Experiment:
    """Two robots in compartments of the paper's size; the second watches the first."""
    demonstrator = RobotSettings("demonstrator", (0.0, 0.0), role=Role.EXPERT)
    observer = RobotSettings("observer", (1.5, 0.0), watches="demonstrator")
    experiment = Experiment(RunSettings("rehearsal"), (demonstrator, observer))
    visits, camera = replace(experiment.visits, profile=profile), replace(experiment.camera, conditions=light)
    return replace(experiment, visits=visits, camera=camera)


class Watcher(Protocol):
    """A Watch, or anything else that turns the observer."""

    def step(self, own_pose: Pose | None, t_ns: int) -> float:
        """The turning speed in rad/s at this tick."""


@dataclass(frozen=True)
class ObservedDemonstration:
    """A demonstration and what the observer made of it."""

    demonstration: Demonstration
    watch: Watch
    copied: Copy | NoCopy
    began_ns: int
    tick_ns: int

    @property
    def copied_moves(self) -> tuple[int, ...]:
        """What was copied; nothing if it was given up."""
        return () if isinstance(self.copied, NoCopy) else tuple(map(int, self.copied.path().moves))

    @property
    def moves_meanwhile(self) -> tuple[int, ...]:
        """The real moves in the time from which moves were copied: what the server compares with."""
        if isinstance(self.copied, NoCopy):
            return ()
        began_ns, ended_ns = self.copied.segments[0].t_start_ns, self.copied.segments[-1].t_end_ns
        shown = self.demonstration
        times_ns = [self.began_ns + middle * self.tick_ns for middle in shown.middles]
        pairs = zip(shown.moves, times_ns, strict=True)
        return tuple(int(move) for move, t_ns in pairs if began_ns <= t_ns <= ended_ns)


class Stage:
    """The observer's place, its body, camera and detector."""

    def __init__(self, experiment: Experiment, rng: np.random.Generator) -> None:
        self._experiment = experiment
        demonstrator, observer = experiment.robot
        self._skirt = demonstrator.skirt
        self._tick_ns = round(experiment.simulation.tick_s * NS_PER_S)
        body_rng, camera_rng = rng.spawn(2)
        self.place = experiment.observers_place(demonstrator)
        walls = experiment.compartment(demonstrator)
        self.room = Rectangle(walls.west_m, walls.south_m, walls.east_m, walls.north_m)
        self.robot = TrackedRobot(experiment, self.place, experiment.compartment(observer), body_rng)
        model = at_profile(experiment.visits.profile, BUILT_IN_MODEL)
        light = SimulatedCamera(model, conditions(experiment.camera.conditions), camera_rng)
        frames = calibration_frames(light, self._skirt, CALIBRATION_RANGES_M)
        learnt = learn_demonstrator(frames, model, Skirt(self._skirt))
        self.detector = Detector(experiment.visits.profile, model, learnt.demonstrator)
        self.camera = SceneCamera(light, self.look)
        self.shown: Callable[[int], Scene | None] = lambda _: Scene((self.room,))
        """What stands before the camera at a tick of the watching, counted from 0; None stalls the camera."""
        self._began_ns = 0
        self._own_before_rad: float | None = None

    def watch(self, demonstration: Demonstration) -> ObservedDemonstration:
        """See the whole demonstration, and copy it."""
        self.shown = self.scenes(demonstration)
        visits = self._experiment.visits
        began_ns = self.settle()
        duration_s = len(demonstration.track) * self._experiment.simulation.tick_s
        pose_at = self.robot.pose_at
        watch = Watch(self.camera, self.detector, pose_at, began_ns, duration_s, visits.frames_per_s)
        self.run(watch, began_ns, len(demonstration.track))
        cell_m = self._experiment.arena.cell_m
        copied = copy_moves(watch.positions, visits.profile, cell_m, watch.expected_frames)
        return ObservedDemonstration(demonstration, watch, copied, began_ns, self._tick_ns)

    def scenes(self, demonstration: Demonstration) -> Callable[[int], Scene]:
        """The compartment and the demonstrator at each tick, with the velocity that blurs its image."""
        track, tick_s = demonstration.track, self._experiment.simulation.tick_s

        def scene(tick: int) -> Scene:
            now = track[min(tick, len(track) - 1)]
            before = track[min(max(tick - 1, 0), len(track) - 1)]
            velocity_m_s = ((now.x_m - before.x_m) / tick_s, (now.y_m - before.y_m) / tick_s)
            return Scene((self.room,), (SceneRobot(now, self._skirt, velocity_m_s),))

        return scene

    def settle(self) -> int:
        """Let the observer stand and learn where it is; returns the time at which the watching begins."""
        for tick in range(1, SETTLE_TICKS):
            self.robot.observe(tick * self._tick_ns)
        self._began_ns = SETTLE_TICKS * self._tick_ns
        return self._began_ns

    def run(self, watcher: Watcher, began_ns: int, ticks: int) -> None:
        """Let the watcher look and turn the observer for so many ticks."""
        geometry = EpuckGeometry()
        for tick in range(ticks):
            t_ns = began_ns + tick * self._tick_ns
            turn_rad_per_s = watcher.step(self.robot.observe(t_ns), t_ns)
            speeds = geometry.wheel_speeds(0.0, turn_rad_per_s) if turn_rad_per_s else STOPPED
            self.robot.body.drive(speeds, t_ns)

    def look(self, t_ns: int) -> tuple[Pose, Scene, float] | None:
        """The observer's true pose, the scene and the turning speed that blurs it."""
        scene = self.shown((t_ns - self._began_ns) // self._tick_ns)
        if scene is None:
            return None
        own = self.robot.body.truth(t_ns)
        before_rad = own.theta_rad if self._own_before_rad is None else self._own_before_rad
        self._own_before_rad = own.theta_rad
        elapsed_s = 1 / self._experiment.visits.frames_per_s
        return own, scene, wrap_angle_rad(own.theta_rad - before_rad) / elapsed_s


ChooseMoves = Callable[[np.random.Generator, Grid, int], tuple[int, tuple[Move, ...]]]
KINDS: dict[str, ChooseMoves] = {"random": random_moves, "expert": expert_moves}
"""random: any moves that stay in the grid; expert: a part of the shortest path."""


def observed_demonstration(
    experiment: Experiment, kind: str, number: int, seed: int
) -> ObservedDemonstration:
    """Show, watch and copy the demonstration of this number, of as many moves as robots remember."""
    rng = spawned_generator(seed, kind, number, "demonstrator", "rehearsal")
    grid = experiment.compartment(experiment.robot[0]).grid
    start, moves = KINDS[kind](rng, grid, experiment.visits.moves)
    return Stage(experiment, rng).watch(demonstrate(experiment, start, moves, rng))


def observed_demonstrations(
    experiment: Experiment, kind: str, count: int, seed: int
) -> Iterator[ObservedDemonstration]:
    """So many demonstrations of one kind."""
    for number in range(count):
        yield observed_demonstration(experiment, kind, number, seed)
