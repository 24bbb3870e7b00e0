"""A robot's visit on an offline stage: the real visit, observer and detector, and rendered frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robot_agent.drivers.interfaces import Camera
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.imitation.visit import Eyes, Visit
from robot_agent.offline.demonstrations import Demonstration, demonstrate
from robot_agent.offline.observation_session import Stage, offline_experiment
from robot_agent.reports import Reporter
from swarm.config.experiment import Experiment
from swarm.geometry import Move
from swarm.learning.memory import ObservedPath
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from tests.support.local_node import LocalNode

TICK_NS = 100_000_000
MOVES = (Move.E, Move.SE, Move.SE, Move.S, Move.E)
OBSERVER = "observer"
VISIT = 3
"""The number of the visit, so that a wrong one would show."""


def experiment() -> Experiment:
    """Visits of 20 s."""
    plain = offline_experiment()
    return replace(plain, visits=replace(plain.visits, duration_s=20.0))


def demonstration(moves: Sequence[Move] = MOVES) -> Demonstration:
    """From a cell in the middle of the compartment."""
    return demonstrate(experiment(), 33, moves, np.random.default_rng(4))


@dataclass
class StagedVisit:
    """A visit that can be stepped; `meddle` is called before every tick with its number."""

    stage: Stage
    camera: Camera
    meddle: Callable[[int], None] = lambda _: None
    remembered: list[ObservedPath] = field(default_factory=list)
    node: LocalNode = field(default_factory=LocalNode)

    def run(self) -> StagedVisit:
        """Until the visit is done; RuntimeError if it is not in half as much time again."""
        settings, place, start_ns = experiment(), self.stage.place, self.stage.settle()
        order = pb.Order(
            kind=pb.Order.WATCH, visit=VISIT, x_m=place.x_m, y_m=place.y_m, theta_rad=place.theta_rad
        )
        visit = Visit(order, self.eyes(settings), EpuckGeometry(), Reporter(self.node, OBSERVER))
        for tick in range(300):
            self.meddle(tick)
            t_ns = start_ns + tick * TICK_NS
            own_pose = self.stage.robot.observe(t_ns)
            if self.stage.robot.displaced:
                visit.displaced()
            self.stage.robot.body.drive(visit.step(own_pose, t_ns), t_ns)
            if visit.done:
                return self
        raise RuntimeError("the visit does not end")

    @property
    def observation(self) -> pb.Observation:
        found = [message for key, message in self.node.published if key == topics.OBSERVATION.key(OBSERVER)]
        assert len(found) == 1
        assert isinstance(found[0], pb.Observation)
        return found[0]

    @property
    def phases(self) -> list[int]:
        return [word.phase for word in self.words]

    @property
    def last_word(self) -> pb.Visit:
        return self.words[-1]

    @property
    def words(self) -> list[pb.Visit]:
        return [message for key, message in self.node.published if key == topics.VISIT.key(OBSERVER)]

    def eyes(self, settings: Experiment) -> Eyes:
        compartment = settings.compartment(settings.robot[0])
        return Eyes(
            self.camera,
            self.stage.detector,
            self.stage.robot.pose_at,
            settings.visits,
            settings.arena.cell_m,
            compartment.centre(compartment.grid.start),
            np.random.default_rng(5),
            self._remember,
        )

    def _remember(self, path: ObservedPath, visit: int) -> int:
        assert visit == VISIT
        self.remembered.append(path)
        return 7


def staged(shown: Demonstration, seed: int = 6) -> StagedVisit:
    """A visit with everything in order."""
    stage = Stage(experiment(), np.random.default_rng(seed))
    stage.shown = stage.scenes(shown)
    return StagedVisit(stage, stage.camera)
