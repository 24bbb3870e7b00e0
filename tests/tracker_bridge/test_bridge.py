"""The bridge: each robot its own pose, the log what was not believed."""

from __future__ import annotations

from collections.abc import Sequence

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from tests.support.local_node import LocalNode
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.bridge import Bridge
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

TICK_NS = NS_PER_S // 10


class Script:
    """A tracking system that says what it was told to."""

    def __init__(self) -> None:
        self.next: list[TrackedPose] = []

    def poses(self, t_ns: int) -> list[TrackedPose]:  # noqa: ARG002
        found, self.next = self.next, []
        return found


class Rig:
    def __init__(self, robots: Sequence[str] = ("a", "b")) -> None:
        self.script, self.node = Script(), LocalNode()
        self.bridge = Bridge(
            self.script, Plausibility(PlausibilitySettings(3.0, 3.0)), self.node, list(robots)
        )

    def step(self, number: int, *places: tuple[str, float]) -> list[tuple[str, object]]:
        """What is published at a tick at which the tracker saw robots at these x."""
        before = len(self.node.published)
        t_ns = number * TICK_NS
        self.script.next = [TrackedPose(robot, Pose(x_m, 1.0, 0.0), t_ns) for robot, x_m in places]
        self.bridge.step(t_ns)
        return self.node.published[before:]


def test_each_robot_gets_its_own_pose_with_the_time_of_capture() -> None:
    rig = Rig()
    own = rig.node.subscribe(topics.POSE, "b")
    published = rig.step(3, ("a", 0.5), ("b", 1.5))
    assert [key for key, _ in published] == ["robot/a/pose", "robot/b/pose"]
    (received,) = own.take()
    assert (received.message.x_m, received.message.captured_t_ns) == (1.5, 3 * TICK_NS)


def test_robots_that_the_experiment_does_not_name_are_left() -> None:
    assert Rig().step(1, ("stranger", 0.5)) == []


def test_a_refused_pose_is_reported_once_for_each_kind() -> None:
    rig = Rig()
    rig.step(0, ("a", 0.5))
    said = [rig.step(number, ("a", 9.0 + number)) for number in range(1, 6)]
    assert [len(published) for published in said] == [1, 0, 0, 0, 0]
    key, event = said[0][0]
    assert key == "tracker/event"
    assert "a: outside the arena, at (10, 1) m" in str(event)


def test_a_robot_without_a_believable_pose_is_reported_lost_once() -> None:
    rig = Rig()
    rig.step(0, ("a", 0.5))
    events = [event for number in range(1, 60) for _, event in rig.step(number)]
    assert len(events) == 1
    assert "a: no believable pose for 2 s" in str(events[0])
    assert [key for key, _ in rig.step(60, ("a", 0.5))] == ["robot/a/pose"]


def test_a_robot_that_the_simulated_hand_carried_surprises_nobody() -> None:
    """Each visit logged a warning; a jump of a robot that nobody carried still does."""
    rig = Rig()
    rig.step(0, ("a", 0.5), ("b", 0.5))
    rig.node.t_ns = TICK_NS
    rig.node.publish(topics.CARRY, pb.Carry(x_m=2.0, y_m=1.0), "a")
    keys = [key for number in range(1, 7) for key, _ in rig.step(number, ("a", 2.0), ("b", 0.5))]
    assert keys.count("robot/a/pose") == 2, "five that agree are still wanted before one is believed"
    assert "tracker/event" not in keys
    assert [key for key, _ in rig.step(7, ("b", 2.0))] == ["tracker/event"]
    assert [key for key, _ in rig.step(22, ("a", 0.5))] == ["tracker/event"], "the hand is gone"
