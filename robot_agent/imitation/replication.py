"""The paper's third stage, "pattern replication": what was seen, as motor commands instead of cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robot_agent.imitation.segments import Segment
from swarm.geometry import Pose, wrap_angle_rad


@dataclass(frozen=True)
class Turn:
    """Turn on the spot, to the left if positive."""

    angle_rad: float


@dataclass(frozen=True)
class Drive:
    """Drive straight on."""

    length_m: float


Command = Turn | Drive


def motor_commands(segments: Sequence[Segment], own_heading_rad: float | None = None) -> tuple[Command, ...]:
    """A turn and a drive for each segment.

    With an own heading (arena frame) the robot first turns to the demonstrator's first heading and repeats
    the pattern as it was; without one it starts the same pattern in the direction it faces.
    """
    commands: list[Command] = []
    for number, segment in enumerate(segments):
        turn_rad = segment.turn_rad
        if number == 0 and own_heading_rad is not None:
            turn_rad = wrap_angle_rad(segment.heading_rad - own_heading_rad)
        commands += [Turn(turn_rad), Drive(segment.length_m)]
    return tuple(commands)


def replicated(start: Pose, commands: Sequence[Command]) -> Pose:
    """Where a robot that executes the commands without error ends."""
    pose = start
    for command in commands:
        step = (
            Pose(0.0, 0.0, command.angle_rad)
            if isinstance(command, Turn)
            else Pose(command.length_m, 0.0, 0.0)
        )
        pose = pose.compose(step)
    return pose
