"""Into a run's log: how far the clock of each board is off."""

from __future__ import annotations

from collections.abc import Iterable

from swarm.messages import swarm_pb2 as pb
from swarm.messages.topics import Topic
from swarm.runtime.node import Node
from swarm.services.chrony import told_offset


def report_clock(node: Node, topic: Topic[pb.Event], robots: Iterable[str] = ("",)) -> None:
    """An event `clock` under every robot's key with what chrony says now; none where chrony is not."""
    if offset := told_offset():
        for robot in robots:
            node.publish(topic, pb.Event(level=pb.Event.INFO, name="clock", text=offset), robot)
