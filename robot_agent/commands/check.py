"""`robot-agent check`: is this robot ready for a run?"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from itertools import islice

from robot_agent.commands.preflight import Finding, Verdict, preflight
from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.epuck_driver import KINDS, opened_body
from robot_agent.drivers.kinematics import EpuckGeometry
from swarm.clock import NS_PER_S, unix_clock
from swarm.errors import RunFailedError, UserError
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.runtime.endpoint import DEFAULT_ENDPOINT
from swarm.runtime.process import OneLineParser, add_protection_arguments, session_settings
from swarm.runtime.zenoh_session import Session, SessionSettings
from swarm.signals import leave_on_signals

TICK_S = 0.1
POSE_TICKS = 50
"""A tracker that gives ten poses a second has given some in five seconds."""
LARGEST_OFFSET_S = 0.2
"""Between the clock of this machine and the tracker's: more, and a pose seems to come from another time."""


def check(arguments: argparse.Namespace) -> None:
    """Try everything, print the table; RunFailedError (exit code 1) if something is bad."""
    leave_on_signals()
    findings = []
    for finding in _findings(arguments):
        findings.append(finding)
        if not arguments.json:
            print(f"{finding.verdict.value:<9} {finding.check:<22} {finding.found}", flush=True)
            if finding.cure:
                print(f"{'':<9} {'':<22} -> {finding.cure}", flush=True)
    if arguments.json:
        rows = [{**vars(finding), "verdict": finding.verdict.value} for finding in findings]
        print(json.dumps({"checks": rows}))
    bad = [finding.check for finding in findings if finding.verdict is Verdict.BAD]
    if bad:
        raise RunFailedError(f"{len(bad)} of {len(findings)} checks: {', '.join(bad)}")


def _findings(arguments: argparse.Namespace) -> Iterator[Finding]:
    body = opened_body(KINDS[arguments.link], arguments.address, EpuckGeometry(), 1.0, _passed_over)
    try:
        try:
            identity = body.wait_for_robot()
        except UserError as error:
            cure = "is it switched on, its selector right, the address this robot's?"
            yield Finding("robot", Verdict.BAD, str(error), cure)
            return
        yield Finding("robot", Verdict.GOOD, f"{identity}, selector {body.selector}")
        yield from preflight(body, unix_clock().ticks(TICK_S), moves=not arguments.stand)
        if arguments.camera or KINDS[arguments.link].has_camera:
            yield from _camera(body, arguments.camera)
    finally:
        body.close()
    if arguments.robot:
        yield from _pose(arguments.robot, session_settings(arguments, arguments.connect, wait_for_hub=False))


def _camera(body: EpuckBody, name: str) -> Iterator[Finding]:
    """What it takes to look at pictures is loaded here and not before."""
    from robot_agent.commands.camera_check import camera_findings
    from robot_agent.drivers.cameras.choice import frames_of

    def ticks() -> Iterator[int]:
        for t_ns in unix_clock().ticks(TICK_S):
            body.wheel_steps(t_ns)
            yield t_ns

    yield from camera_findings(frames_of(name, body.take_picture), ticks())


def _passed_over(name: str, text: str) -> None:
    """Events go into a run's log; here the findings say what matters."""


def _pose(robot: str, settings: SessionSettings) -> Iterator[Finding]:
    """Whether the tracker sees the robot, and whether its clock agrees with this machine's."""
    with Session(settings) as session:
        inbox = session.inbox(topics.POSE.key(robot), topics.POSE.delivery)
        for _ in islice(unix_clock().ticks(TICK_S), POSE_TICKS):
            if samples := inbox.poll():
                header = Header.unpack(samples[-1].attachment)
                break
        else:
            cure = "is the tracker bridge running, the robot's hat in view, the id right?"
            yield Finding("tracker pose", Verdict.BAD, f"no pose of {robot} in 5 s", cure)
            return
    yield Finding("tracker pose", Verdict.GOOD, f"a pose of {robot} has come")
    offset_s = (time.time_ns() - header.t_ns) / NS_PER_S if header else 0.0
    agrees = abs(offset_s) <= LARGEST_OFFSET_S
    verdict = Verdict.GOOD if agrees else Verdict.BAD
    cure = "" if agrees else "synchronise the clocks (chrony or systemd-timesyncd) with the tracker's machine"
    yield Finding("clock", verdict, f"{offset_s:+.3f} s off the tracker's", cure)


def check_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent check",
        description="Tries a real robot before a run. It drives each wheel 2.6 cm forward and back: keep it "
        "on the floor, or give --stand.",
    )
    parser.add_argument("link", choices=tuple(KINDS), help="how the robot is reached")
    parser.add_argument("address", nargs="?", default="", help="where (see robots.md)")
    parser.add_argument("--stand", action="store_true", help="do not turn the wheels")
    parser.add_argument(
        "--camera", default="", metavar="NAME", help="another camera than that on the link: /dev/videoN"
    )
    parser.add_argument("--robot", default="", metavar="ID", help="look for its pose from the tracker too")
    parser.add_argument("--connect", default=DEFAULT_ENDPOINT, metavar="tls/HOST:PORT", help="the server")
    add_protection_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print the findings as one JSON object")
    return parser
