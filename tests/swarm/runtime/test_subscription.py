"""Feeds: duplicates, restarts, newest wins, and what is bad."""

from __future__ import annotations

from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.runtime.subscription import BACK_AFTER, Subscription

POSE = pb.Pose(x_m=0.5, y_m=0.25, theta_rad=1.0).SerializeToString()
MOVE = pb.Move(number=1).SerializeToString()


def header(sequence: int, epoch: int = 1) -> Header:
    return Header(epoch, sequence, 0)


def test_every_message_of_a_reliable_topic_is_kept_in_order() -> None:
    subscription = Subscription(topics.MOVE)
    for number in (1, 2, 3):
        subscription.put("robot/a/move", header(number), pb.Move(number=number).SerializeToString())
    received = subscription.take()
    assert [(one.robot, one.header.sequence, one.message.number) for one in received] == [
        ("a", 1, 1),
        ("a", 2, 2),
        ("a", 3, 3),
    ]
    assert subscription.take() == []


def test_the_newest_state_of_each_key_wins() -> None:
    subscription = Subscription(topics.POSE)
    for robot, number, x_m in (("a", 1, 0.1), ("b", 1, 0.2), ("a", 2, 0.3)):
        subscription.put(f"robot/{robot}/pose", header(number), pb.Pose(x_m=x_m).SerializeToString())
    assert sorted((one.robot, one.message.x_m) for one in subscription.take()) == [("a", 0.3), ("b", 0.2)]


def test_duplicates_and_messages_of_a_dead_process_are_left_out() -> None:
    subscription = Subscription(topics.MOVE)
    for epoch, sequence in ((5, 1), (5, 1), (5, 3), (5, 2), (6, 1), (5, 4)):
        subscription.put("robot/a/move", header(sequence, epoch), pb.Move(number=1).SerializeToString())
    assert [(one.header.epoch, one.header.sequence) for one in subscription.take()] == [
        (5, 1),
        (5, 3),
        (6, 1),
    ]
    assert subscription.duplicates == 3


def test_bad_messages_are_counted_and_explained() -> None:
    subscription = Subscription(topics.POSE)
    subscription.put("robot/a/pose", header(1), POSE)
    subscription.put("robot/b/pose", header(1), b"\xff\xff no protobuf")
    assert [one.robot for one in subscription.take()] == ["a"]
    subscription.put("robot/a/pose", None, POSE)
    subscription.put("robot/NOT AN ID/pose", header(1), POSE)
    subscription.put("robot/a/pose", header(2), pb.Pose(x_m=float("nan")).SerializeToString())
    assert subscription.take() == []
    assert subscription.bad == 4
    assert "robot/a/pose" in subscription.last_bad
    assert "x_m is nan" in subscription.last_bad


def test_a_bad_message_of_a_later_epoch_does_not_silence_the_sender() -> None:
    subscription = Subscription(topics.POSE)
    subscription.put("robot/a/pose", header(1, epoch=5), POSE)
    assert len(subscription.take()) == 1
    subscription.put("robot/a/pose", header(1, epoch=9), b"\xff\xffgarbage")
    assert subscription.take() == []
    subscription.put("robot/a/pose", header(2, epoch=5), POSE)
    assert [one.header.sequence for one in subscription.take()] == [2]
    subscription.put("robot/a/pose", header(2, epoch=5), POSE)
    assert subscription.take() == []
    assert (subscription.bad, subscription.duplicates) == (1, 1)


def test_a_sender_that_restarts_with_its_clock_set_back_is_accepted() -> None:
    subscription = Subscription(topics.MOVE)
    for epoch, sequence in ((9000, 1), (9000, 2), (5000, 1), (5000, 2), (9000, 3), (5000, 3)):
        subscription.put("robot/a/move", header(sequence, epoch), MOVE)
    accepted = [(one.header.epoch, one.header.sequence) for one in subscription.take()]
    assert accepted == [(9000, 1), (9000, 2), (5000, 1), (5000, 2), (5000, 3)]
    assert subscription.duplicates == 1, "the dead one's late message"


def test_a_late_message_of_a_dead_process_silences_nobody_for_good() -> None:
    """It comes to a subscriber that never heard that process, in between the messages of the living one."""
    subscription = Subscription(topics.MOVE)
    subscription.put("robot/a/move", header(1, epoch=5), MOVE)
    subscription.put("robot/a/move", header(70, epoch=4), MOVE)
    for sequence in range(2, 20):
        subscription.put("robot/a/move", header(sequence, epoch=5), MOVE)
    accepted = [one.header.sequence for one in subscription.take() if one.header.epoch == 5]
    assert accepted == [1, *range(1 + BACK_AFTER, 20)]
