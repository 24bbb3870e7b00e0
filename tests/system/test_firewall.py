"""Nothing crosses from one robot to another but what its camera sees: all keys received are listed."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.messages import topics
from swarm.runtime.receipts import read_receipts
from tests.support.camera_runs import PLACES, camera_experiment_text
from tests.support.swarm_runs import messages, run_server, write_experiment


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Robots that watch each other, each in a process of its own."""
    directory = tmp_path_factory.mktemp("firewall")
    run_server(write_experiment(directory, camera_experiment_text()), directory / "run")
    return directory / "run"


def heard(run: Path, number: int) -> set[str]:
    _, received = read_receipts(run / "output" / "trial-000" / f"robots-{number}.keys")
    return {name.partition(" ")[0] for name in received}


@pytest.mark.parametrize(("number", "robot"), list(enumerate(PLACES)))
def test_a_robot_hears_nothing_of_another(run: Path, number: int, robot: str) -> None:
    received = heard(run, number)
    found = {key: topics.topic_of(key) for key in received}
    for key, topic in found.items():
        assert topic is not None, key
        assert topic[1] in ("", robot), f"{robot} received {key}"
    to_robots = {topic for topic in topics.TABLE if topic.to_robot} | {topics.CARRY, topics.VIEW}
    assert {topic[0] for topic in found.values() if topic} <= to_robots


@pytest.mark.parametrize(("number", "robot"), list(enumerate(PLACES)))
def test_the_list_is_not_empty(run: Path, number: int, robot: str) -> None:
    """Each robot heard its own pose and the run's state; each that watches, its order and its camera."""
    expected = {"run/state", f"robot/{robot}/pose"}
    if robot != "expert":
        expected |= {f"robot/{robot}/order", f"sim/{robot}/view", f"sim/{robot}/carry"}
    assert expected <= heard(run, number)


def test_paths_were_copied_in_this_run(run: Path) -> None:
    """The others' moves did cross, through the cameras: a run without visits would show nothing."""
    copied = {robot for robot, path in messages(run / "trial-000.mcap", "path") if path.source == "camera"}
    assert copied >= {"pupil"}
    visited = {robot for robot, _ in messages(run / "trial-000.mcap", "visit")}
    assert visited == {"pupil", "left", "right"}
