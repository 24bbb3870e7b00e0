"""The three stages of section 3.2 in a row: frames, straight segments, and the pattern's replication."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry
from robot_agent.imitation.copying import NoCopy
from robot_agent.imitation.observer import Watch
from robot_agent.imitation.pattern import Similarity, corners_of, seen_pattern, similarity
from robot_agent.imitation.replication import Arrival, motor_commands, replicate
from robot_agent.imitation.segments import Segment
from robot_agent.navigation.located_robot import LocatedRobot
from robot_agent.navigation.motion import Motion
from swarm.config.experiment import CopyProfile

SETTLE_TICKS = 20
"""Two seconds: a heading from a tracker of half a degree of noise has settled by then."""

BeginWatch = Callable[[int], Watch]
"""Begins to watch at a time."""


@dataclass(frozen=True)
class Imitation:
    """What was seen, where the robot stood when it began to drive, and where each drive ended."""

    segments: tuple[Segment, ...]
    start: Arrival
    ends: list[Arrival]

    @property
    def similarity(self) -> Similarity:
        """Of the driven pattern to the seen one."""
        driven = [(at.pose.x_m, at.pose.y_m) for at in (self.start, *self.ends)]
        return similarity(corners_of(self.segments), driven)


def stand(robot: LocatedRobot) -> Generator[None, int, Arrival]:
    """Stand until the own pose is known well."""
    known = 0
    while True:
        t_ns = yield
        pose = robot.observe(t_ns)
        robot.body.drive(STOPPED, t_ns)
        known += pose is not None
        if pose is not None and known >= SETTLE_TICKS:
            return Arrival(t_ns, pose)


def imitate_pattern(
    robot: LocatedRobot,
    motion: Motion,
    geometry: EpuckGeometry,
    begin_watch: BeginWatch,
    profile: CopyProfile,
) -> Generator[None, int, Imitation | NoCopy]:
    """Watch another robot, then drive its pattern: takes the time at each tick.

    The pattern is driven in the directions in which it was seen, from where the robot stands.
    """
    t_ns = (yield from stand(robot)).t_ns
    watch = begin_watch(t_ns)
    while not watch.ended(t_ns):
        t_ns = yield
        turn_rad_per_s = watch.step(robot.observe(t_ns), t_ns)
        speeds = geometry.wheel_speeds(0.0, turn_rad_per_s) if turn_rad_per_s else STOPPED
        robot.body.drive(speeds, t_ns)
    if watch.failed:
        return NoCopy(watch.failed)
    segments = seen_pattern(watch.positions, profile, watch.expected_frames)
    if isinstance(segments, NoCopy):
        return segments
    start = yield from stand(robot)
    commands = motor_commands(segments, start.pose.theta_rad)
    ends = yield from replicate(robot, motion, start.pose, commands)
    return Imitation(segments, start, ends)
