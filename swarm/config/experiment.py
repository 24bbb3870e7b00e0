"""What an experiment file says: the run, the arena, the rules of learning, the robots.

`Experiment.load` is the one door: it also checks what no single value shows, such as two robots of one id.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from swarm.config.changes import changes_of
from swarm.config.consistency import check_consistency
from swarm.config.limits import BEYOND_CORNER_M, LARGEST_SEED, MOST_MOVES, MOST_PROCESSES
from swarm.config.toml_files import Between, ConfigFile
from swarm.geometry import Compartment, Grid, Pose
from swarm.learning.controller import Controller
from swarm.learning.learner import Learner
from swarm.learning.memory import Approach, ImitationMemory, ObservedPath
from swarm.learning.q_table import QTable
from swarm.learning.random import spawned_generator

OLDEST_POSE_S = 0.9
"""A tenth below the second at which a robot stands for want of a newer pose."""

REAL_LINKS = ("serial", "wifi", "i2c", "spi")
"""Drivers of real robots; a simulation runs them against emulated ones."""


class Role(Enum):
    """What a robot does in its compartment."""

    LEARNER = "learner"
    EXPERT = "expert"


class WithoutServer(StrEnum):
    """What a robot does that no longer hears the server."""

    WAIT = "wait"
    """It finishes its move and waits."""
    STOP = "stop"
    """It gives up its move, stands at once and waits."""


@dataclass(frozen=True)
class RunSettings:
    """[run]: how long, how often, and from which seed."""

    name: str
    """The run's name, an id: it also names the run's directory."""
    moves: Annotated[int, Between(1, MOST_MOVES)] = 15_000
    """Moves of each learner in a trial; the paper's 15,000 take about 10 hours on robots."""
    trials: Annotated[int, Between(1, 10_000)] = 1
    """Repetitions, each with new robots and random numbers of its own."""
    seed: Annotated[int, Between(0, LARGEST_SEED)] = 1
    """The one root of all randomness; the same seed gives the same log."""
    without_server: WithoutServer = WithoutServer.WAIT
    """What a robot does that no longer hears the server: wait after the move under way, or stop at once."""
    without_server_s: Annotated[float, Between(2, 3600)] = 5.0
    """Silence after which it does so; the run's state comes once a second, and a lost one stops nobody."""


@dataclass(frozen=True)
class LogSettings:
    """[log]: when a trial's log goes on in another file, each of which can be read alone."""

    file_mb: Annotated[float, Between(0.1, 1_000_000)] = 256.0
    """Size of a file in 10^6 bytes: a log of ten robots takes a day or so to fill one."""
    file_h: Annotated[float, Between(0.01, 10_000)] = 24.0
    """Hours of the run in one file."""


@dataclass(frozen=True)
class ArenaSettings:
    """[arena]: the floor, and the grid of every compartment."""

    width_m: Annotated[float, Between(0.1, 100)] = 3.0
    """The floor, from west to east."""
    height_m: Annotated[float, Between(0.1, 100)] = 3.0
    """The floor, from south to north."""
    cell_m: Annotated[float, Between(0.05, 10)] = 0.12
    """The side of a cell."""
    columns: Annotated[int, Between(2, 100)] = 10
    """Cells of a compartment, from west to east."""
    rows: Annotated[int, Between(2, 100)] = 10
    """Cells of a compartment, from north to south."""


@dataclass(frozen=True)
class LearningSettings:
    """[learning]: the rules of equations 2 to 7, and the robots' pace."""

    epsilon: Annotated[float, Between(0, 1)] = 0.1
    """Probability of a random move."""
    beta: Annotated[float, Between(0, 0.999)] = 0.5
    """Regulates the initial imitation probability; below 1 for the convergence proof."""
    approach: Approach = Approach.AVERAGE_Q
    """How R is counted: not at all, by completed replays (eq. 2), or by replays that raised Q (eq. 3, 4)."""
    capacity: Annotated[int, Between(1, 1000)] = 10
    """Paths in the memory; on robots a full memory copies no more."""
    discount_rate_per_s: Annotated[float, Between(0, 100)] = 0.149
    """Eq. 7's beta: 0.149/s is a discount of 0.7 over a move of 2.4 s."""
    blocked_move_s: Annotated[float, Between(0, 60)] = 0.5
    """A move into a wall is decided, not driven; the robot stands still this long."""
    rest_s: Annotated[float, Between(0, 60)] = 1.5
    """Standing still in the goal and in the start: what tells a watcher where a journey ends."""
    path_length_cap: Annotated[int, Between(1, 100_000)] = 100
    """What a greedy path that never arrives counts as."""


@dataclass(frozen=True)
class BodySettings:
    """[body]: faults of the simulated wheels."""

    slip_sd: Annotated[float, Between(0, 0.5)] = 0.01
    """Standard deviation of each wheel's relative slip in a tenth of a second."""
    gain_error_sd: Annotated[float, Between(0, 0.5)] = 0.015
    """Standard deviation of each wheel's relative error in size."""
    latency_s: Annotated[float, Between(0, 0.2)] = 0.06
    """From a command to its effect; robots that obey later than two ticks turn too far and never arrive."""


@dataclass(frozen=True)
class TrackerSettings:
    """[tracker]: which tracking system, where it is, how its axes lie; and the simulated one's faults."""

    backend: str = "sim"
    """The tracking system: see trackers.md, and how-to-add-a-tracker.md for a new one."""
    server: str = ""
    """The address of the system's own computer; empty if it sends to all, as Vicon's stream may."""
    interface: str = "0.0.0.0"
    """The address of this machine at which its packets arrive."""
    port: Annotated[int, Between(0, 65_535)] = 0
    """The port at which they arrive; 0 is the system's usual one."""
    command_port: Annotated[int, Between(0, 65_535)] = 0
    """The port at which the server takes questions; 0 is the system's usual one."""
    multicast: str = ""
    """The group that the system sends to (Motive: 239.255.42.99); empty if it sends to this machine alone."""
    version: str = ""
    """The protocol's version, for a server that does not answer when asked for it."""
    system: str = ""
    """Which system the `motioncapture` library talks to: vicon, qualisys, vrpn or optitrack."""
    options: tuple[str, ...] = ()
    """More settings of that library, each as `name=value`."""
    file: str = ""
    """What `replay` plays (a CSV export, or a log), or the tags and cameras of `overhead`, or the hats."""
    axes: str = "x y z"
    """The system's axes that point to the arena's east, north and up: `x -z y` if its y is up."""
    unit_m: Annotated[float, Between(0, 100)] = 0.0
    """Metres in one unit of the system; 0 is the unit that the system always uses."""
    origin_m: tuple[float, float] = (0.0, 0.0)
    """Where the system's origin lies in the arena; `tracker-bridge calibrate` finds it."""
    turn_rad: Annotated[float, Between(-2 * math.pi, 2 * math.pi)] = 0.0
    """How far the system's east is turned, counter-clockwise, from the arena's."""
    rate_hz: Annotated[float, Between(1, 1000)] = 10.0
    """Poses of each robot a second; a robot stands when the last is 1 s old."""
    noise_m: Annotated[float, Between(0, 0.02)] = 0.001
    """Standard deviation of x and of y; with more, poses look as if somebody carried the robot."""
    noise_rad: Annotated[float, Between(0, 1)] = 0.0087
    """Standard deviation of the heading."""
    latency_s: Annotated[float, Between(0, 0.5)] = 0.06
    """At least this late; in lockstep a pose arrives two exchanges after it was true."""
    loss: Annotated[float, Between(0, 0.9)] = 0.02
    """Share of poses that are missing."""
    blackouts_per_hour: Annotated[float, Between(0, 600)] = 10.0
    """Longer losses of one robot."""
    blackout_s: Annotated[float, Between(0, 60)] = 3.0
    """How long such a loss lasts."""


class CopyProfile(StrEnum):
    """How what was seen becomes moves."""

    BEST = "best"
    """320 x 240, edges to a fraction of a pixel, smoothing, and the moves that explain all of it."""
    PAPER = "paper"
    """160 x 120, the number of the patch's pixels, regression lines."""


@dataclass(frozen=True)
class VisitSettings:
    """[visits]: when robots watch others, and how (section 3.4)."""

    every_tracks: Annotated[int, Between(1, 100_000)] = 10
    """A learner visits at the start and after so many journeys, until its memory is full."""
    duration_s: Annotated[float, Between(1, 600)] = 30.0
    """How long a learner watches; with `frames_per_s` for at most 500 frames."""
    frames_per_s: Annotated[float, Between(0.5, 30)] = 5.0
    """Camera frames that are looked at while watching."""
    moves: Annotated[int, Between(1, 100)] = 5
    """Consecutive moves that are remembered of what was seen."""
    profile: CopyProfile = CopyProfile.BEST
    """How frames become moves; see copying.md."""


@dataclass(frozen=True)
class CameraSettings:
    """[camera]: the camera of robots that watch."""

    calibration: str = ""
    """A calibration file (deploy/cameras), to which `robot-agent calibrate` adds the demonstrator; the
    simulated camera has one built in."""
    colours: str = ""
    """A colour table of a former version, for a calibration file without a demonstrator; with neither, the
    simulated camera learns the demonstrator at the start."""
    conditions: str = "realistic"
    """Light of the simulated camera: realistic, hard, dark or clean."""


@dataclass(frozen=True)
class SimulationSettings:
    """[simulation]: the length of a tick and the number of processes for the robots."""

    tick_s: Annotated[float, Between(0.01, 0.2)] = 0.1
    """Control period of every robot, and the length of a lockstep tick."""
    ticks_per_exchange: Annotated[int, Between(1, 10)] = 2
    """Ticks that the processes of a lockstep make before they exchange messages; fewer if a camera takes more
    frames, or if poses would come too late to drive by. A pose comes two exchanges late, 0.4 s; with 1 it is
    0.2 s, and a run takes half as long again."""
    processes: Annotated[int, Between(0, MOST_PROCESSES)] = 0
    """Processes that host the robots; 0 gives each robot its own, as on hardware."""


@dataclass(frozen=True)
class RobotSettings:
    """[[robot]]: one robot, its compartment and what it may imitate."""

    id: str
    """The robot's name in every key and in the log: a small letter, then at most 31 of a-z, 0-9, _ and -."""
    south_west_m: tuple[float, float]
    """The compartment's corner in the arena frame."""
    driver: str = "sim"
    """What moves it: sim, serial, wifi, i2c, spi (robots.md), or one of your own (how-to-add-a-driver.md)."""
    address: str = ""
    """Where a real robot is: a serial port or Bluetooth address, HOST:PORT, an I2C bus, an SPI device."""
    wheel_diameter_m: Annotated[float, Between(0.03, 0.06)] = 0.041
    """Of a real robot's wheels, as calibrated; 1000 steps are a turn."""
    wheel_base_m: Annotated[float, Between(0.04, 0.07)] = 0.053
    """Between a real robot's wheels, as calibrated; published values go from 52 to 57 mm."""
    keep_off_m: Annotated[float, Between(0, 0.05)] = 0.0
    """A real robot drives no further towards what is nearer than this (the obstacle reflex); 0: it does."""
    camera: str = ""
    """A real robot's camera: that on its link if empty, /dev/videoN, a folder of pictures, or a video."""
    role: Role = Role.LEARNER
    """A learner learns; an expert follows the shortest path indefinitely."""
    condition: str = ""
    """Learners of one condition share a curve; the role's name if empty."""
    watches: str = ""
    """The robot whose moves it copies through its camera; none if empty."""
    accesses: str = ""
    """The learner whose internal state it may read (section 2.4); none if empty. Nothing else permits more
    than observation between robots, and `swarm check --firewall` tells of it."""
    skirt: str = "red"
    """The colour of its skirt, by which others see it."""
    paths: tuple[tuple[str, ...], ...] = ()
    """Paths given at the start, each a list of compass moves."""
    body: str = ""
    """Its name in a real tracking system; its id if empty."""
    body_turn_rad: Annotated[float, Between(-2 * math.pi, 2 * math.pi)] = 0.0
    """From where that system says it faces to where it does, counter-clockwise."""

    @property
    def group(self) -> str:
        return self.condition or self.role.value

    def given_paths(self) -> tuple[ObservedPath, ...]:
        return tuple(ObservedPath.parse(path) for path in self.paths)


@dataclass(frozen=True)
class Experiment:
    """An experiment file, checked."""

    run: RunSettings
    robot: tuple[RobotSettings, ...]
    arena: ArenaSettings = field(default_factory=ArenaSettings)
    learning: LearningSettings = field(default_factory=LearningSettings)
    body: BodySettings = field(default_factory=BodySettings)
    tracker: TrackerSettings = field(default_factory=TrackerSettings)
    visits: VisitSettings = field(default_factory=VisitSettings)
    camera: CameraSettings = field(default_factory=CameraSettings)
    simulation: SimulationSettings = field(default_factory=SimulationSettings)
    log: LogSettings = field(default_factory=LogSettings)

    @classmethod
    def load(cls, path: Path, changes: Iterable[str] | None = None) -> Experiment:
        """Read and check an experiment file, with what `--set` changes in it.

        UserError names the file and line, or the option, and the cure.
        """
        return cls._of(ConfigFile(path, changes=changes_of(changes)))

    @classmethod
    def of_log(cls, log: str, text: str, learning: Mapping[str, Any]) -> Experiment:
        """The experiment that a log was recorded from, with these values in its [learning]."""
        file = ConfigFile(Path(f"{log} (its experiment)"), text)
        file.values["learning"] = {**file.values.get("learning", {}), **learning}
        return cls._of(file)

    @classmethod
    def of_settings(cls, source: str, settings: Mapping[str, str]) -> Experiment:
        """The experiment whose every setting somebody tells as JSON, by `table.key` or `robot.ID.key`."""
        file = ConfigFile(Path(source), "")
        robots: dict[str, dict[str, Any]] = {}
        for name, text in settings.items():
            *table, key = name.split(".")
            of_robot = table[0] == "robot"
            group = robots.setdefault(table[1], {}) if of_robot else file.values.setdefault(table[0], {})
            group[key] = json.loads(text)
        file.values["robot"] = list(robots.values())
        return cls._of(file)

    @classmethod
    def _of(cls, file: ConfigFile) -> Experiment:
        experiment = file.settings(cls)
        check_consistency(experiment, file)
        return experiment

    def changed(
        self, seed: int | None = None, moves: int | None = None, processes: int | None = None
    ) -> Experiment:
        """The same experiment with what a command line gave in place of the file's values."""
        run = replace(
            self.run,
            seed=self.run.seed if seed is None else seed,
            moves=self.run.moves if moves is None else moves,
        )
        simulation = self.simulation
        if processes is not None:
            simulation = replace(simulation, processes=processes)
        return replace(self, run=run, simulation=simulation)

    def seen_by(self, calibration: Path) -> Experiment:
        """The same experiment for a board whose camera is calibrated by a file of its own."""
        return replace(self, camera=replace(self.camera, calibration=str(calibration)))

    def compartment(self, robot: RobotSettings) -> Compartment:
        """The walled square that belongs to a robot."""
        grid = Grid(self.arena.columns, self.arena.rows)
        return Compartment(*robot.south_west_m, grid, self.arena.cell_m)

    def generator(self, robot: RobotSettings, trial: int, component: str) -> np.random.Generator:
        """The random numbers of one component of a robot in a trial: the same for it and its surrogate."""
        return spawned_generator(self.run.seed, robot.group, trial, robot.id, component)

    def learner(self, robot: RobotSettings, trial: int) -> Learner:
        """A robot's learner by the rules of [learning], with an empty memory."""
        rules, grid = self.learning, self.compartment(robot).grid
        memory = ImitationMemory(rules.beta, rules.approach, rules.capacity)
        choices = self.generator(robot, trial, "controller")
        return Learner(
            grid,
            Controller(QTable(grid.states), memory, rules.epsilon, choices),
            self.generator(robot, trial, "evaluation"),
            rules.path_length_cap,
            rules.discount_rate_per_s,
        )

    def observers_place(self, demonstrator: RobotSettings) -> Pose:
        """Where a robot stands to watch: just outside the compartment's south-east corner, facing in.

        The paper's place, in that corner, lies inside the goal cell, which the demonstrator enters.
        """
        watched = self.compartment(demonstrator)
        return Pose(watched.east_m + BEYOND_CORNER_M, watched.south_m - BEYOND_CORNER_M, 0.75 * math.pi)

    def robot_named(self, name: str) -> RobotSettings:
        return next(robot for robot in self.robot if robot.id == name)

    @property
    def ticks_per_exchange(self) -> int:
        """As in the settings, but no more than a pose may be late by, which takes two exchanges to arrive.

        With cameras also at most those between two frames, which would else be the same.
        """
        in_time = math.floor((OLDEST_POSE_S - self.tracker.latency_s) / (2 * self.simulation.tick_s) + 1e-9)
        between_frames = math.floor(1 / (self.visits.frames_per_s * self.simulation.tick_s) + 1e-9)
        watched = any(robot.watches for robot in self.robot)
        most = min(in_time, between_frames) if watched else in_time
        return min(self.simulation.ticks_per_exchange, max(1, most))

    @property
    def pose_lateness_s(self) -> float:
        """How old a simulated pose is when it leaves the tracker: it was an exchange on its way there."""
        return self.tracker.latency_s + (self.ticks_per_exchange + 1) * self.simulation.tick_s

    def is_accessed(self, robot: RobotSettings) -> bool:
        """Whether another may read a robot's internal state."""
        return any(other.accesses == robot.id for other in self.robot)

    @property
    def learners(self) -> tuple[RobotSettings, ...]:
        return tuple(robot for robot in self.robot if robot.role is Role.LEARNER)
