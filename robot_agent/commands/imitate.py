"""`robot-agent imitate`: watch another robot through the camera, then drive the pattern that it drove."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Generator, Sequence

from robot_agent.addresses import addresses
from robot_agent.assembly import Assembly, Place
from robot_agent.commands.node_steps import run_steps
from robot_agent.commands.robot_arguments import add_robot_arguments, require_robot
from robot_agent.drivers.interfaces import Driver, DriverParts
from robot_agent.drivers.reflex import with_reflex
from robot_agent.drivers.registry import make_driver
from robot_agent.imitation.assembly import sight_of
from robot_agent.imitation.copying import NoCopy
from robot_agent.imitation.imitation import Imitation, imitate_pattern, stand
from robot_agent.imitation.observer import Watch
from robot_agent.imitation.replication import Arrival, Command, Drive, Turn, replicate
from robot_agent.navigation.located_robot import Fixes, LocatedRobot
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseEstimator
from swarm.config.experiment import RobotSettings
from swarm.errors import RunFailedError, UserError
from swarm.geometry import Pose
from swarm.messages import topics
from swarm.runtime.node import Node
from swarm.runtime.process import OneLineParser, joined, load_experiment
from swarm.signals import leave_on_signals

Steps = Generator[None, int, dict[str, object]]
"""Takes the time at each tick, returns the report."""


def imitate(arguments: argparse.Namespace) -> None:
    """Watch and drive, or with a pattern drive only; say how it came out."""
    experiment = load_experiment(arguments)
    require_robot(arguments, experiment)
    commands = parsed_pattern(arguments.pattern)
    if not commands:
        _require_sight(experiment.robot_named(arguments.robot))
    leave_on_signals()
    with joined(arguments, "imitation", [arguments.robot], experiment.simulation.tick_s, None) as node:
        place = Place(addresses(arguments.address), arguments.speed, arguments.lockstep)
        parts = Assembly(experiment, node, arguments.trial, place).driver_parts(arguments.robot)
        driver = make_driver(parts)
        fixes = None if arguments.by_wheels else fixes_of(node, arguments.robot)
        located = LocatedRobot(
            with_reflex(driver.body, parts.robot.keep_off_m), PoseEstimator(parts.geometry), fixes
        )
        try:
            steps = (
                _shown(located, parts, commands) if commands else _imitated(located, parts, driver, arguments)
            )
            report = run_steps(node, steps)
        finally:
            driver.body.close()
    print(json.dumps(report) if arguments.json else _text(report))


def _require_sight(robot: RobotSettings) -> None:
    """UserError if the robot has nobody to watch, or a camera that nobody here shows anything."""
    if not robot.watches:
        raise UserError(f"robot {robot.id!r} watches nobody: set `watches`, or give it a --pattern")
    if robot.driver == "sim":
        raise UserError(
            f"robot {robot.id!r} is simulated: its camera is shown something in visits of a run only; "
            "give it a --pattern, or a real or emulated robot's driver"
        )


def fixes_of(node: Node, robot: str) -> Fixes:
    """The tracker's poses of a robot."""
    poses = node.subscribe(topics.POSE, robot)

    def fixes() -> list[tuple[Pose, int]]:
        taken = [(received.message, received.header.t_ns) for received in poses.take()]
        return [(Pose(pose.x_m, pose.y_m, pose.theta_rad), t_ns) for pose, t_ns in taken]

    return fixes


def parsed_pattern(text: str) -> tuple[Command, ...]:
    """Turns in degrees and drives in metres from a text such as "0 0.25, 90 0.2"; UserError if it is none."""
    commands: list[Command] = []
    for part in filter(None, text.split(",")):
        try:
            turn_deg, length_m = map(float, part.split())
        except ValueError as error:
            raise UserError(
                f'--pattern {part.strip()!r}: say degrees and metres of each segment, as in "0 0.25, 90 0.2"'
            ) from error
        commands += [Turn(math.radians(turn_deg)), Drive(length_m)]
    return tuple(commands)


def _shown(robot: LocatedRobot, parts: DriverParts, commands: Sequence[Command]) -> Steps:
    """Drive a pattern for others to see."""
    start = yield from stand(robot)
    ends = yield from replicate(robot, _motion(parts), start.pose, commands)
    return {"driven_m": _corners(start, ends)}


def _imitated(
    robot: LocatedRobot, parts: DriverParts, driver: Driver, arguments: argparse.Namespace
) -> Steps:
    visits = parts.experiment.visits
    camera, detector = sight_of(parts, driver)

    def begin_watch(t_ns: int) -> Watch:
        return Watch(camera, detector, robot.pose_at, t_ns, arguments.watch_s, visits.frames_per_s)

    result = yield from imitate_pattern(robot, _motion(parts), parts.geometry, begin_watch, visits.profile)
    if isinstance(result, NoCopy):
        raise RunFailedError(f"nothing to imitate: {result.reason}")
    return _report(result)


def _motion(parts: DriverParts) -> Motion:
    return Motion(MotionSettings(period_s=parts.experiment.simulation.tick_s), parts.geometry)


def _report(imitation: Imitation) -> dict[str, object]:
    alike = imitation.similarity
    segments = [
        {"turn_rad": round(segment.turn_rad, 4), "length_m": round(segment.length_m, 4)}
        for segment in imitation.segments
    ]
    return {
        "seen": segments,
        "driven_m": _corners(imitation.start, imitation.ends),
        "similarity": round(alike.overall, 4),
        "lengths": round(alike.lengths, 4),
        "turns": round(alike.turns, 4),
        "corner_error_m": round(alike.corner_error_m, 4),
    }


def _corners(start: Arrival, ends: Sequence[Arrival]) -> list[tuple[float, float]]:
    return [(round(at.pose.x_m, 4), round(at.pose.y_m, 4)) for at in (start, *ends)]


def _text(report: dict[str, object]) -> str:
    return "\n".join(f"{name:<15} {value}" for name, value in report.items())


def imitate_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent imitate",
        description="Watches the robot that the experiment names (`watches`), then drives its pattern as "
        "turns and moves, from where it stands. Give it as much room as the pattern takes.",
    )
    add_robot_arguments(parser)
    parser.add_argument(
        "--watch-s", type=float, default=30.0, metavar="SECONDS", help="how long (%(default)s)"
    )
    parser.add_argument(
        "--pattern", default="", metavar='"DEG M, ..."', help="drive this for others to see; watch nobody"
    )
    parser.add_argument("--by-wheels", action="store_true", help="without a tracker, by the step counters")
    return parser
