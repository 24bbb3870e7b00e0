"""A real track of two robots at 300 Hz, as it is and as faults would make it, through gate and bridge."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from tests.support.local_node import LocalNode
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.replay import replay
from tracker_bridge.bridge import Bridge
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

FILE = Path(__file__).parents[1] / "data" / "tracks" / "two_robots_qualisys_300hz.csv.gz"
SETTINGS = PlausibilitySettings(3.0, 3.0)
FRAMES = 19_520
FAULT = 5_000
"""The number of the pose from which a fault lasts: after 8 s, when both robots have driven."""
REPAIRED = 7_000


@cache
def track() -> tuple[TrackedPose, ...]:
    """All poses of both robots, in the order in which they were captured."""
    experiment = tracked_experiment(TrackerSettings(), ["a", "b"], ["rubber", "40d"])
    recording = replay(experiment, FILE)
    recording.poses(0)
    return tuple(recording.poses(10**12))


def verdicts(poses: list[TrackedPose]) -> list[tuple[str, str | None]]:
    plausibility = Plausibility(SETTINGS)
    return [(tracked.robot, plausibility.reason_against(tracked)) for tracked in poses]


def altered(alter: Callable[[Pose], Pose]) -> list[TrackedPose]:
    poses = list(track())
    after = [tracked._replace(pose=alter(tracked.pose)) for tracked in poses[FAULT:]]
    return poses[:FAULT] + after


def test_nothing_is_refused_and_nothing_smoothed_away() -> None:
    poses, node = list(track()), LocalNode()
    assert len(poses) > 1.95 * FRAMES
    script = Script(poses)
    bridge = Bridge(script, Plausibility(SETTINGS), node, ["a", "b"])
    for tick in range(poses[-1].captured_t_ns // script.tick_ns + 2):
        bridge.step(tick * script.tick_ns)
    assert [(key, message.x_m, message.y_m) for key, message in node.published] == [
        (f"robot/{tracked.robot}/pose", tracked.pose.x_m, tracked.pose.y_m) for tracked in poses
    ]


def test_single_differences_would_have_fired() -> None:
    """Or this track would prove nothing about a gate of 0.5 m/s."""
    own = [tracked for tracked in track() if tracked.robot == "a"]
    speeds = [
        later.pose.distance_m(earlier.pose) / ((later.captured_t_ns - earlier.captured_t_ns) / 1e9)
        for earlier, later in pairwise(own)
    ]
    assert max(speeds) > SETTINGS.fastest_m_per_s


def test_ids_that_swap_are_named_for_as_long_as_they_are_swapped() -> None:
    poses = list(track())
    other = {"a": "b", "b": "a"}
    poses[FAULT:REPAIRED] = [
        tracked._replace(robot=other[tracked.robot]) for tracked in poses[FAULT:REPAIRED]
    ]
    said = verdicts(poses)
    assert all(reason is None for _, reason in said[:FAULT])
    assert all(
        (reason or "").startswith(f"swapped with {other[robot]}?") for robot, reason in said[FAULT:REPAIRED]
    )
    assert all(reason is None for _, reason in said[REPAIRED:])


def test_a_tracker_that_freezes_is_named() -> None:
    poses = list(track())
    held = {tracked.robot: tracked.pose for tracked in poses[:FAULT]}
    frozen = [tracked._replace(pose=held[tracked.robot]) for tracked in poses[FAULT:]]
    said = verdicts(poses[:FAULT] + frozen)[FAULT:]
    assert all((reason or "").startswith("frozen") for _, reason in said[2 * SETTINGS.frozen_after :])


@pytest.mark.parametrize(
    ("alter", "named"),
    [
        (lambda pose: Pose(1000 * pose.x_m, 1000 * pose.y_m, pose.theta_rad), "is it in millimetres?"),
        (
            lambda pose: Pose(10_000 * pose.x_m, 10_000 * pose.y_m, pose.theta_rad),
            "is it in units of 0.1 mm?",
        ),
        (lambda pose: Pose(pose.x_m, pose.y_m, math.degrees(pose.theta_rad)), "is it in degrees?"),
        (lambda pose: Pose(pose.x_m, -pose.y_m, pose.theta_rad), "is y mirrored?"),
    ],
    ids=["mm", "tenths", "degrees", "mirrored"],
)
def test_a_wrong_unit_and_a_mirror_are_named(alter: Callable[[Pose], Pose], named: str) -> None:
    said = [reason or "" for _, reason in verdicts(altered(alter))[FAULT:]]
    named_share = sum(named in reason for reason in said) / len(said)
    assert named_share > (0.9 if named != "is it in degrees?" else 0.5)
    assert not any(reason == "" for reason in said if named != "is it in degrees?")


def test_a_robot_that_is_cut_off_is_lost_and_delays_nobody() -> None:
    poses, node = list(track()), LocalNode()
    kept = [tracked for number, tracked in enumerate(poses) if number < FAULT or tracked.robot == "b"]
    script = Script(kept)
    bridge = Bridge(script, Plausibility(SETTINGS), node, ["a", "b"])
    for tick in range(poses[-1].captured_t_ns // script.tick_ns + 2):
        bridge.step(tick * script.tick_ns)
    events = [message.text for _, message in node.published if isinstance(message, pb.Event)]
    assert events == ["a: no believable pose for 2 s"]
    assert sum(key == "robot/b/pose" for key, _ in node.published) == sum(p.robot == "b" for p in poses)


class Script:
    """Gives poses at the ticks at which they are due."""

    tick_ns = 2_000_000

    def __init__(self, poses: list[TrackedPose]) -> None:
        self._poses = poses
        self._next = 0

    def poses(self, t_ns: int) -> list[TrackedPose]:
        first = self._next
        while self._next < len(self._poses) and self._poses[self._next].captured_t_ns <= t_ns:
            self._next += 1
        return self._poses[first : self._next]
