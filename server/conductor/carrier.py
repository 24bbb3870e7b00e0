"""Who carries a robot to the observer's place and back: a simulated hand, or the laboratory's operator."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from server.conductor.prompts import Prompts
from server.reporter import Reporter
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics


class Carrier(Protocol):
    """Carries robots."""

    def relocate(self, robot: str, to: Pose, why: str) -> None:
        """Have a robot stand at a place; it confirms by its own pose that it does."""


class SimulatedCarrier:
    """Moves a simulated robot at once."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter

    def relocate(self, robot: str, to: Pose, why: str) -> None:  # noqa: ARG002
        self._reporter.publish(topics.CARRY, pb.Carry(x_m=to.x_m, y_m=to.y_m, theta_rad=to.theta_rad), robot)


class Operator:
    """Asks a person: on the terminal, in the log, and wherever somebody sees how the run goes."""

    def __init__(self, reporter: Reporter, ask: Callable[[str], None], prompts: Prompts) -> None:
        self._reporter = reporter
        self._ask = ask
        self._prompts = prompts

    def relocate(self, robot: str, to: Pose, why: str) -> None:
        place = f"x {to.x_m:.2f} m, y {to.y_m:.2f} m, heading {to.theta_rad:.2f} rad"
        text = f"please carry {robot} to {place}: {why}"
        number = self._prompts.ask(robot, to, text)
        self._ask(f"{text} (prompt {number})")
        self._reporter.event("carry", text, pb.Event.WARNING)
