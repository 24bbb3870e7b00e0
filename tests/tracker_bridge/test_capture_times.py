"""A tracking system whose clock is wrong, is set, or says one wrong time."""

from __future__ import annotations

import pytest

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.messages import topics
from tests.support.local_node import LocalNode
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.bridge import Bridge
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

TICK_NS = NS_PER_S // 10
START_NS = 1_790_000_000 * NS_PER_S


class Rig:
    """A robot that drives along x, and a tracking system whose clock says what a test wants."""

    def __init__(self) -> None:
        self.node = LocalNode()
        self._poses: list[TrackedPose] = []
        self._bridge = Bridge(self, Plausibility(PlausibilitySettings(3.0, 3.0)), self.node, ["a"])
        self._tick = 0

    def poses(self, t_ns: int) -> list[TrackedPose]:  # noqa: ARG002
        return self._poses

    def ticks(self, count: int, ahead_s: float) -> list[int | None]:
        """How old each pose that came was by the time it was passed on (ns), None for one that was not."""
        ages: list[int | None] = []
        for _ in range(count):
            self._tick += 1
            t_ns = START_NS + self._tick * TICK_NS
            captured_t_ns = t_ns - TICK_NS // 2 + round(ahead_s * NS_PER_S)
            self._poses = [TrackedPose("a", Pose(0.5 + 0.001 * self._tick, 1.0, 0.0), captured_t_ns)]
            before = len(self.node.published)
            self._bridge.step(t_ns)
            sent = [message for key, message in self.node.published[before:] if key.endswith("/pose")]
            ages.append(t_ns - sent[0].captured_t_ns if sent else None)
        return ages

    @property
    def events(self) -> list[str]:
        key = topics.TRACKER_EVENT.key()
        return [message.name for published, message in self.node.published if published == key]


def test_one_pose_from_the_far_future_costs_that_pose() -> None:
    rig = Rig()
    assert None not in rig.ticks(10, 0.0)
    assert rig.ticks(1, 1e6) == [None]
    assert None not in rig.ticks(10, 0.0)


@pytest.mark.parametrize("ahead_s", [-3600.0, 3600.0, -3.0])
def test_a_clock_that_steps_costs_some_poses_and_is_told_of(ahead_s: float) -> None:
    rig = Rig()
    rig.ticks(10, 0.0)
    ages = rig.ticks(20, ahead_s)
    assert ages[:4] == [None] * 4
    assert all(age is not None and 0 <= age <= TICK_NS for age in ages[4:])
    assert rig.events.count("clock") == 1
