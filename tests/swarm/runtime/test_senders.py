"""A forged message silences nobody and moves nobody, also without certificates."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from itertools import count

import pytest

from swarm.clock import unix_clock
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.messages.topics import Delivery
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.node import LiveNode, LivePublisher
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint

PERIOD_S = 0.01
FUTURE = 2**62
TRUE_M, FORGED_M = 1.0, 2.0


class Robot:
    """A robot that hears its pose and the run's state, and somebody who forges both."""

    def __init__(self, stack: ExitStack) -> None:
        endpoint = free_endpoint()
        self.server, self.forger, own = (
            stack.enter_context(Session(SessionSettings(endpoint, hub=hub))) for hub in (True, False, False)
        )
        claim(self.server, Presence("server", "server", "here", 5))
        claim(self.server, Presence("tracker", "bridge", "here", 6))
        self._state = LivePublisher(self.server, unix_clock(), 5)
        self._pose = LivePublisher(self.server, unix_clock(), 6)
        self.node = LiveNode(own, unix_clock(), PERIOD_S, epoch=7)
        self._poses = self.node.subscribe(topics.POSE, "r0")
        self.places: list[float] = []
        self._numbers = count(1)

    def hear(self, forge: object, poses: int) -> None:
        """Step until so many true poses were heard; the forger has its turn before each."""

        def step(t_ns: int) -> None:  # noqa: ARG001
            assert callable(forge)
            forge(next(self._numbers))
            self._pose.publish(topics.POSE, pb.Pose(x_m=TRUE_M), "r0")
            self.places += [pose.message.x_m for pose in self._poses.take()]
            if self.places.count(TRUE_M) >= poses:
                self._state.publish(topics.RUN_STATE, pb.RunState(phase=pb.RunState.ENDED))

        self.node.run(step)

    def forges(self, epoch: int, sequence: int) -> None:
        """A pose, a run that has ended, and messages that are none."""
        header = Header(epoch, sequence, 0).pack()
        for key, payload in (
            (topics.POSE.key("r0"), pb.Pose(x_m=FORGED_M).SerializeToString()),
            (topics.RUN_STATE.key(), pb.RunState(phase=pb.RunState.ENDED).SerializeToString()),
            (topics.POSE.key("r0"), b"\xff\xff"),
        ):
            self.forger.publisher(key, Delivery.EVERY).put(payload, attachment=header)


@pytest.fixture
def robot() -> Iterator[Robot]:
    with ExitStack() as stack:
        yield Robot(stack)


def test_epochs_that_somebody_makes_up_count_for_nothing(robot: Robot) -> None:
    robot.hear(lambda number: robot.forges(FUTURE + number, 1), poses=30)
    assert set(robot.places) == {TRUE_M}
    assert len(robot.places) >= 30, "the forged end did not end it"


def test_of_two_under_one_name_the_first_counts(robot: Robot) -> None:
    for kind, name in (("tracker", "bridge"), ("server", "server")):
        robot.forger.declare_alive(Presence(kind, name, "cellar", FUTURE).key)
    robot.hear(lambda number: robot.forges(FUTURE, number), poses=30)
    assert set(robot.places) == {TRUE_M}


def test_who_may_not_send_a_topic_is_not_believed_under_its_own_epoch(robot: Robot) -> None:
    robot.forger.declare_alive(Presence("robot", "r1", "board", 8).key)
    robot.hear(lambda number: robot.forges(8, number), poses=30)
    assert set(robot.places) == {TRUE_M}
