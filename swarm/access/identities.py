"""Whom a laboratory knows: each has a certificate of its own."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from swarm.messages.topics import Role


@dataclass(frozen=True)
class Identity:
    """A robot with its id, or one of those of whom there is one each."""

    role: Role
    robot: str = ""

    def __str__(self) -> str:
        """Its name in commands, files and certificates: `server`, `robot-r1`."""
        return f"{self.role.value}-{self.robot}" if self.robot else self.role.value


SERVER = Identity(Role.SERVER)
TRACKER = Identity(Role.TRACKER)
OPERATOR = Identity(Role.OPERATOR)
VIEWER = Identity(Role.VIEWER)


def identities(robots: Iterable[str]) -> list[Identity]:
    """Everyone in a laboratory with these robots."""
    return [SERVER, TRACKER, OPERATOR, VIEWER, *(Identity(Role.ROBOT, robot) for robot in robots)]
