"""Who carries a robot to the observer's place and back: a simulated hand, or the laboratory's operator."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from google.protobuf.message import Message

from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic

Publish = Callable[[Topic[Any], Message, str], None]


class Carrier(Protocol):
    """Carries robots."""

    def relocate(self, robot: str, to: Pose, why: str) -> None:
        """Have a robot stand at a place; it confirms by its own pose that it does."""


class SimulatedCarrier:
    """Moves a simulated robot at once."""

    def __init__(self, publish: Publish) -> None:
        self._publish = publish

    def relocate(self, robot: str, to: Pose, why: str) -> None:  # noqa: ARG002
        self._publish(topics.CARRY, pb.Carry(x_m=to.x_m, y_m=to.y_m, theta_rad=to.theta_rad), robot)


class Operator:
    """Asks a person, on the terminal and in the log."""

    def __init__(self, publish: Publish, ask: Callable[[str], None]) -> None:
        self._publish = publish
        self._ask = ask

    def relocate(self, robot: str, to: Pose, why: str) -> None:
        place = f"x {to.x_m:.2f} m, y {to.y_m:.2f} m, heading {to.theta_rad:.2f} rad"
        text = f"please carry {robot} to {place}: {why}"
        self._ask(text)
        self._publish(topics.SERVER_EVENT, pb.Event(level=pb.Event.WARNING, name="carry", text=text), "")
