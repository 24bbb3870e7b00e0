"""The key table, and the page made from it."""

from __future__ import annotations

import pytest

from swarm.messages import topics
from swarm.messages.topic_reference import markdown_table
from swarm.messages.topics import TABLE, is_id, topic_of
from tests.support.swarm_runs import ROOT


@pytest.mark.parametrize("name", ["a", "r1", "a" * 32, "e-puck_7"])
def test_ids(name: str) -> None:
    assert is_id(name)


@pytest.mark.parametrize("name", ["", "1a", "A", "a" * 33, "a/b", "a b", "../x", "a*", "ä", "a\n", "-a"])
def test_what_is_no_id(name: str) -> None:
    assert not is_id(name)


def test_every_topic_is_found_by_its_key() -> None:
    for topic in TABLE:
        robot = "r1" if "{robot}" in topic.pattern else ""
        assert topic_of(topic.key(robot)) == (topic, robot)


@pytest.mark.parametrize(
    "key", ["robot/r1/poses", "robot/r1/pose/x", "robot/R1/pose", "robot//pose", "robot/a/b/pose", "x", ""]
)
def test_unknown_keys_are_of_no_topic(key: str) -> None:
    assert topic_of(key) is None


def test_patterns_are_distinct() -> None:
    assert len({topic.pattern for topic in TABLE}) == len(TABLE)


def test_a_robot_receives_its_own_pose_and_orders_the_run_s_state_and_emergency_stops() -> None:
    """The paper's firewall: nothing but what the camera sees crosses from robot to robot."""
    received = {topics.POSE, topics.ORDER, topics.RUN_STATE, topics.ESTOP}
    assert {topic for topic in TABLE if topic.to_robot} == received


def test_the_documentation_is_made_from_the_table() -> None:
    """If this fails: python -m swarm.messages.topic_reference > docs/keys.md."""
    assert (ROOT / "docs" / "keys.md").read_text(encoding="utf-8") == markdown_table()
