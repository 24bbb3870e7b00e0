"""Experiments with a real tracking system, and a swarm that stands where the examiners want it."""

from __future__ import annotations

import math
import socket
from collections.abc import Sequence

from swarm.config.experiment import ArenaSettings, Experiment, RobotSettings, RunSettings, TrackerSettings
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose

LOOPBACK = "127.0.0.1"
PITCH_M = 1.3
PLACES = {"a": Pose(1.0, 0.5, math.pi / 2), "b": Pose(2.0, 1.5, math.pi)}


def tracked_experiment(
    tracker: TrackerSettings, robots: Sequence[str] = ("a", "b"), bodies: Sequence[str] = ()
) -> Experiment:
    """An experiment of robots in a row; `bodies` are their names in the tracking system."""
    settings = [
        RobotSettings(robot, (PITCH_M * number, 0.0), body=bodies[number] if bodies else "")
        for number, robot in enumerate(robots)
    ]
    arena = ArenaSettings(width_m=max(3.0, PITCH_M * len(robots)))
    return Experiment(RunSettings("tracked"), tuple(settings), arena, tracker=tracker)


def standing(t_ns: int) -> list[TrackedPose]:
    """The examiners' two robots."""
    return [TrackedPose(robot, pose, t_ns) for robot, pose in PLACES.items()]


def free_udp_port() -> int:
    """A port of this machine's own that nobody uses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((LOOPBACK, 0))
        port: int = probe.getsockname()[1]
        return port
