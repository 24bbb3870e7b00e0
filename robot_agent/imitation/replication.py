"""The paper's third stage, "pattern replication": what was seen, as motor commands instead of cells."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass

from robot_agent.imitation.segments import Segment
from robot_agent.navigation.located_robot import LocatedRobot
from robot_agent.navigation.motion import Motion
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


@dataclass(frozen=True)
class Arrival:
    """Where the robot believes that a drive ended, and when."""

    t_ns: int
    pose: Pose


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
        pose = _after(pose, command)
    return pose


def replicate(
    robot: LocatedRobot, motion: Motion, start: Pose, commands: Sequence[Command]
) -> Generator[None, int, list[Arrival]]:
    """Execute the commands: takes the time at each tick; returns where each drive ended.

    Each leg goes to where the robot should be after it, so that errors do not add up.
    """
    planned = start
    ends: list[Arrival] = []
    for command in commands:
        planned = _after(planned, command)
        if isinstance(command, Turn):
            motion.turn_to(planned.theta_rad)
        else:
            motion.go_to(planned.x_m, planned.y_m)
        arrival = yield from _leg(robot, motion)
        if isinstance(command, Drive):
            ends.append(arrival)
    return ends


def _leg(robot: LocatedRobot, motion: Motion) -> Generator[None, int, Arrival]:
    """Drive until the motion's leg has ended."""
    while True:
        t_ns = yield
        pose = robot.observe(t_ns)
        robot.body.drive(motion.step(pose, t_ns, robot.pose_age_s(t_ns)), t_ns)
        if motion.arrived and pose:
            return Arrival(t_ns, pose)


def _after(pose: Pose, command: Command) -> Pose:
    if isinstance(command, Turn):
        return pose.compose(Pose(0.0, 0.0, command.angle_rad))
    return pose.compose(Pose(command.length_m, 0.0, 0.0))
