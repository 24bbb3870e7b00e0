"""What a robot in the full simulation knows and does, against where it really was."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from swarm.clock import NS_PER_S
from tests.support.swarm_runs import experiment_text, learners, messages, run_server, write_experiment

NOISE_M = 0.001


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("run")
    file = write_experiment(directory, experiment_text(learners(1), moves=60))
    run_server(file, directory / "out")
    return directory / "out" / "trial-000.mcap"


def truths(log: Path) -> Iterator[tuple[int, Any]]:
    """The truth is published at every tick from the first on."""
    yield from (
        (number * NS_PER_S // 10, truth) for number, (_, truth) in enumerate(messages(log, "truth"), 1)
    )


def test_a_pose_carries_the_time_at_which_it_was_true(log: Path) -> None:
    true = dict(truths(log))
    errors_m = [
        math.hypot(pose.x_m - true[pose.captured_t_ns].x_m, pose.y_m - true[pose.captured_t_ns].y_m)
        for _, pose in messages(log, "pose")
    ]
    assert len(errors_m) > 500
    assert max(errors_m) < 6 * NOISE_M


def test_the_robot_knows_where_it_is(log: Path) -> None:
    pairs = list(zip(messages(log, "command"), messages(log, "truth"), strict=True))
    errors_m = sorted(math.hypot(c.x_m - t.x_m, c.y_m - t.y_m) for (_, c), (_, t) in pairs[50:])
    assert errors_m[len(errors_m) // 2] < 0.001


def test_moves_take_the_time_that_the_motion_study_found(log: Path) -> None:
    driven_s = [move.duration_s for _, move in messages(log, "move") if not move.blocked]
    assert 2.0 < sum(driven_s) / len(driven_s) < 2.6


def test_no_wall_is_touched(log: Path) -> None:
    assert [truth.wall_contacts for _, truth in truths(log)][-1] == 0
