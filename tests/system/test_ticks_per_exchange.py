"""Several ticks to an exchange: the same rates, poses a little later, and still the same bytes."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from server.recording.recorder import digest
from tests.support.swarm_runs import experiment_text, learners, messages, run_server, write_experiment

TICKS = 2
TICK_NS = 100_000_000


def log_of(directory: Path, *options: str) -> Path:
    text = experiment_text(learners(2), 12, f"[simulation]\nticks_per_exchange = {TICKS}")
    run_server(write_experiment(directory, text), directory / "out", *options)
    return directory / "out" / "trial-000.mcap"


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return log_of(tmp_path_factory.mktemp("exchange"))


def test_the_number_of_processes_does_not_show(log: Path, tmp_path: Path) -> None:
    assert digest([log_of(tmp_path, "--processes", "1")]) == digest([log])


def test_the_tracker_keeps_its_rate(log: Path) -> None:
    captured = [pose.captured_t_ns for robot, pose in messages(log, "pose") if robot == "r0"]
    steps = [later - sooner for sooner, later in pairwise(captured)]
    assert steps.count(TICK_NS) > 0.9 * len(steps)


def test_the_robots_step_at_every_tick(log: Path) -> None:
    commands = sum(robot == "r0" for robot, _ in messages(log, "command"))
    truths = sum(robot == "r0" for robot, _ in messages(log, "truth"))
    assert commands == truths > 200
