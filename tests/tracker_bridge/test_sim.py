"""The simulated tracking system: its rate, noise, lateness and losses, as set."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from swarm.clock import NS_PER_S
from swarm.config.experiment import TrackerSettings
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.runtime.subscription import Received
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.sim import SimulatedTracker

TICK_NS = NS_PER_S // 10
PERFECT = TrackerSettings(noise_m=0.0, noise_rad=0.0, latency_s=0.0, loss=0.0, blackouts_per_hour=0.0)


def tracked(
    settings: TrackerSettings, ticks: int, robots: tuple[str, ...] = ("a",)
) -> list[list[TrackedPose]]:
    """What the tracker gives at each tick for robots that drive east at 1 cm a tick."""
    waiting: list[Received[pb.Truth]] = []

    def truths() -> list[Received[pb.Truth]]:
        found = waiting.copy()
        waiting.clear()
        return found

    tracker = SimulatedTracker(settings, truths, lambda robot: np.random.default_rng(ord(robot[0])))
    given = []
    for tick in range(ticks):
        truth = pb.Truth(x_m=0.01 * tick, y_m=1.0, theta_rad=0.5)
        waiting.extend(Received(robot, Header(1, tick + 1, tick * TICK_NS), truth) for robot in robots)
        given.append(tracker.poses(tick * TICK_NS))
    return given


def flat(given: list[list[TrackedPose]]) -> list[TrackedPose]:
    return [pose for poses in given for pose in poses]


def test_without_faults_it_tells_the_truth_at_once() -> None:
    given = tracked(PERFECT, 50)
    assert [len(poses) for poses in given] == [1] * 50
    assert all(pose.pose.x_m == pytest.approx(0.1 * pose.captured_t_ns / NS_PER_S) for pose in flat(given))


def test_a_slower_rate_leaves_frames_out() -> None:
    given = tracked(replace(PERFECT, rate_hz=2.0), 100)
    assert [pose.captured_t_ns for pose in flat(given)] == [5 * TICK_NS * number for number in range(20)]


def test_noise_has_the_size_that_was_set() -> None:
    settings = replace(PERFECT, noise_m=0.002, noise_rad=0.01)
    poses = flat(tracked(settings, 4000))
    errors_m = [pose.pose.x_m - 0.1 * pose.captured_t_ns / NS_PER_S for pose in poses]
    headings_rad = [pose.pose.theta_rad - 0.5 for pose in poses]
    for errors, sd in ((errors_m, 0.002), (headings_rad, 0.01)):
        assert abs(np.mean(errors)) < 4 * sd / len(poses) ** 0.5
        assert np.std(errors) == pytest.approx(sd, rel=0.05)


def test_a_late_pose_keeps_its_time_of_capture() -> None:
    given = tracked(replace(PERFECT, latency_s=0.25), 20)
    assert [len(poses) for poses in given[:3]] == [0, 0, 0]
    for tick in range(3, 20):
        assert [pose.captured_t_ns for pose in given[tick]] == [(tick - 3) * TICK_NS]


def test_single_poses_are_lost_as_often_as_was_set() -> None:
    count, loss = 5000, 0.1
    lost = count - len(flat(tracked(replace(PERFECT, loss=loss), count)))
    assert abs(lost - loss * count) < 4 * (count * loss * (1 - loss)) ** 0.5


def test_blackouts_last_as_long_as_was_set() -> None:
    settings = replace(PERFECT, blackouts_per_hour=60.0, blackout_s=3.0)
    ticks = 60_000
    times = [pose.captured_t_ns for pose in flat(tracked(settings, ticks))]
    gaps = [later - sooner for sooner, later in pairwise(times)]
    blackouts = [gap for gap in gaps if gap > TICK_NS]
    assert min(blackouts) == 31 * TICK_NS, "thirty frames are missing"
    expected = 60.0 * ticks / 36_000
    assert abs(len(blackouts) - expected) < 4 * expected**0.5


def test_one_robot_s_poses_do_not_depend_on_the_others() -> None:
    settings = TrackerSettings(loss=0.2)
    alone = flat(tracked(settings, 200))
    together = [pose for pose in flat(tracked(settings, 200, ("b", "a", "c"))) if pose.robot == "a"]
    assert alone == together
