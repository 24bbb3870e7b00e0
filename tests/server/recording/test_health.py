"""Rates seen against rates declared."""

from __future__ import annotations

from typing import Any

from google.protobuf.message import Message

from server.hubs.hub import Batch
from server.recording.health import Health
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import Topic

TICK_NS = NS_PER_S // 10


class Rig:
    def __init__(self) -> None:
        self.reported: list[tuple[str, str]] = []
        self.levels: list[int] = []
        self.health = Health(Reporter(self))
        self._tick = 0

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        assert (topic, robot) == (topics.SERVER_EVENT, "")
        assert isinstance(message, pb.Event)
        self.reported.append((message.name, message.text))
        self.levels.append(message.level)

    def seconds(self, seconds: int, poses_every: int) -> None:
        """A tick has a pose whenever its number is a multiple, and always a move."""
        for _ in range(10 * seconds):
            self._tick += 1
            names = ["robot/a/pose"] if self._tick % poses_every == 0 else []
            items = [Item(name, Header(1, 1, 0), b"") for name in (*names, "robot/a/move")]
            self.health.step(Batch(self._tick * TICK_NS, items))


def test_a_key_at_its_declared_rate_is_well() -> None:
    rig = Rig()
    rig.seconds(60, poses_every=1)
    assert rig.reported == []
    assert rig.health.lowest_share["robot/a/pose"] > 0.98
    assert "robot/a/move" not in rig.health.lowest_share, "no rate is declared"


def test_a_key_that_falls_behind_is_reported_once_and_again_when_it_recovers() -> None:
    rig = Rig()
    rig.seconds(20, poses_every=1)
    rig.seconds(40, poses_every=5)
    assert [name for name, _ in rig.reported] == ["slow"]
    assert "robot/a/pose: 20%" in rig.reported[0][1]
    rig.seconds(40, poses_every=1)
    assert [name for name, _ in rig.reported] == ["slow", "recovered"]
    assert rig.levels == [pb.Event.WARNING, pb.Event.INFO]
    assert rig.health.lowest_share["robot/a/pose"] < 0.25


def test_a_key_that_falls_silent_is_reported() -> None:
    rig = Rig()
    rig.seconds(20, poses_every=1)
    rig.seconds(30, poses_every=10_000)
    assert rig.reported[-1] == ("slow", "robot/a/pose: 0% of the declared rate")
