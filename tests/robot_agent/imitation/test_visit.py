"""The robot's side of a visit: it is ready, waits until it stands at its place, watches, copies, is done."""

from __future__ import annotations

import numpy as np
import pytest

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry
from robot_agent.imitation.visit import Visit
from robot_agent.offline.observation_session import Stage
from robot_agent.reports import Reporter
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from tests.support.staged_visit import (
    MOVES,
    OBSERVER,
    TICK_NS,
    StagedVisit,
    demonstration,
    experiment,
    staged,
)


@pytest.fixture(scope="module")
def done() -> StagedVisit:
    return staged(demonstration()).run()


def test_it_says_how_it_goes(done: StagedVisit) -> None:
    assert done.phases == [pb.Visit.READY, pb.Visit.WATCHING, pb.Visit.DONE]
    assert done.last_word.visit == 3


def test_what_was_copied_is_remembered_and_reported(done: StagedVisit) -> None:
    assert [path.moves for path in done.remembered] == [MOVES]
    assert done.last_word.path == 7
    assert list(done.observation.window) == list(map(int, MOVES))


def waiting_visit() -> tuple[Visit, StagedVisit]:
    """A visit that was just ordered, and whom it speaks to."""
    stage = Stage(experiment(), np.random.default_rng(1))
    scaffold = StagedVisit(stage, stage.camera)
    order = pb.Order(kind=pb.Order.WATCH, visit=1, x_m=1.25, y_m=-0.05, theta_rad=2.356)
    reporter = Reporter(scaffold.node, OBSERVER)
    return Visit(order, scaffold.eyes(experiment()), EpuckGeometry(), reporter), scaffold


PLACE = Pose(1.25, -0.05, 2.356)
BESIDE = Pose(1.25, 0.01, 2.356)


def poses(visit: Visit, *stands: tuple[Pose | None, int]) -> None:
    """Step through so many ticks at each pose."""
    tick = 0
    for pose, ticks in stands:
        for _ in range(ticks):
            assert visit.step(pose, tick * TICK_NS) == STOPPED
            tick += 1


def test_it_does_not_watch_before_it_has_stood_at_its_place_for_a_second() -> None:
    visit, said = waiting_visit()
    poses(visit, (None, 20), (BESIDE, 40), (PLACE, 10))
    assert said.phases == [pb.Visit.READY]
    visit.step(PLACE, 70 * TICK_NS)
    assert said.phases == [pb.Visit.READY, pb.Visit.WATCHING]


def test_the_second_begins_anew_when_the_robot_is_carried_on() -> None:
    visit, said = waiting_visit()
    poses(visit, (PLACE, 9), (BESIDE, 1), (PLACE, 9))
    visit.displaced()
    visit.step(PLACE, 19 * TICK_NS)
    assert said.phases == [pb.Visit.READY]


def test_a_visit_that_is_done_turns_no_wheel() -> None:
    """The robot stands until it is carried back."""
    visit, _ = waiting_visit()
    visit.done = True
    assert visit.step(PLACE, 0) == STOPPED
