"""Where emulators have their robots from."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
import pytest

from swarm.clock import NS_PER_S, WallClock
from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.emulators.motion import Circles, TruthOfRun
from tracker_bridge.emulators.serving import serve


def test_circles_stay_in_the_compartments_at_a_robots_pace() -> None:
    experiment = tracked_experiment(TrackerSettings())
    circles = Circles(experiment, np.random.default_rng(1))
    seen = [circles.poses(second * NS_PER_S) for second in range(60)]
    for robot, places in zip(experiment.robot, zip(*seen, strict=True), strict=True):
        compartment = experiment.compartment(robot)
        assert all(compartment.state_at(each.pose.x_m, each.pose.y_m) is not None for each in places)
        steps_m = [earlier.pose.distance_m(later.pose) for earlier, later in pairwise(places)]
        assert steps_m == pytest.approx([0.1] * 59, abs=0.005)
        assert len({each.pose for each in places}) == 60


def test_a_runs_robots_are_where_the_run_says() -> None:
    endpoint, rng = free_endpoint(), np.random.default_rng(1)
    with (
        Session(SessionSettings(endpoint, hub=True)) as hub,
        TruthOfRun.of(SessionSettings(endpoint), rng) as truth,
    ):
        publisher = hub.publisher(topics.TRUTH.key("a"), topics.TRUTH.delivery)
        seen: list[TrackedPose] = []
        while not seen:
            publisher.put(pb.Truth(x_m=1.0, y_m=0.5, theta_rad=0.3).SerializeToString())
            seen = truth.poses(7)
    assert (seen[0].robot, seen[0].captured_t_ns) == ("a", 7)
    assert seen[0].pose.distance_m(Pose(1.0, 0.5, 0.0)) < 0.002
    assert seen[0].pose.theta_rad == pytest.approx(0.3, abs=0.02)


class Shown:
    """An emulator that keeps what it is shown."""

    def __init__(self) -> None:
        self.frames: list[list[float]] = []

    def show(self, poses: Iterable[TrackedPose], t_ns: int) -> None:  # noqa: ARG002
        self.frames.append([tracked.pose.x_m for tracked in poses])

    def close(self) -> None:
        """There is nothing to close."""


class TwiceATick:
    """Motion that was measured more often than it is served."""

    def poses(self, t_ns: int) -> list[TrackedPose]:
        return [TrackedPose("a", Pose(x_m, 0.0, 0.0), t_ns) for x_m in (1.0, 2.0)]


def test_a_frame_has_each_robot_once_where_it_was_last() -> None:
    now_ns = [0]

    def sleep(seconds: float) -> None:
        now_ns[0] += round(seconds * NS_PER_S)

    shown = Shown()
    serve(shown, TwiceATick(), WallClock(0, 0, monotonic_ns=lambda: now_ns[0], sleep=sleep), 0.1, 0.5)
    assert shown.frames == [[2.0]] * 5
