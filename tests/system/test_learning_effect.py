"""Figure 25's effect on the fast model of a move, and the fast model against the full simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from swarm.config.experiment import LearningSettings
from tests.benchmarks.learning_effect import LENGTH, curves
from tests.conftest import SmallRun
from tests.support.fast_moves import Kind, SurrogateRobot, durations_in
from tests.support.swarm_runs import experiment_text, learners, messages, run_server, write_experiment

RULES = LearningSettings()


@pytest.fixture(scope="session")
def durations(tmp_path_factory: pytest.TempPathFactory) -> dict[Kind, list[float]]:
    """Of moves in a full simulation."""
    directory = tmp_path_factory.mktemp("durations")
    file = write_experiment(directory, experiment_text(learners(4), 100, "[simulation]\nprocesses = 2"))
    run_server(file, directory / "run")
    return durations_in(directory / "run" / "trial-000.mcap")


def test_every_kind_of_move_was_seen(durations: dict[Kind, list[float]]) -> None:
    """Turning further takes longer, and a diagonal longer than a side."""
    assert set(durations) == {(turn, diagonal) for turn in range(5) for diagonal in range(2)}
    mean = {kind: float(np.mean(seen)) for kind, seen in durations.items()}
    for diagonal in range(2):
        assert mean[0, diagonal] < mean[2, diagonal] < mean[4, diagonal]


def test_a_path_makes_learning_quick(durations: dict[Kind, list[float]]) -> None:
    """Eight trials; 40 and more are in `tests/benchmarks/learning_effect.py`."""
    at, with_path = curves(durations, RULES, 8, 1500, given=True)
    _, without = curves(durations, RULES, 8, 1500, given=False)
    assert at[-1] == 1500
    assert with_path[:, -1].mean() <= LENGTH
    assert without[:, -1].mean() > 4 * LENGTH


@pytest.mark.long
def test_figure_25_over_twenty_trials(durations: dict[Kind, list[float]]) -> None:
    at, with_path = curves(durations, RULES, 20, 1500, given=True)
    assert with_path[:, at.index(1500)].mean() <= LENGTH
    at, without = curves(durations, RULES, 20, 8000, given=False)
    assert without[:, at.index(8000)].mean() > LENGTH


def test_a_blocked_move_takes_what_the_fast_model_takes(small_run: SmallRun) -> None:
    blocked_s = {move.duration_s for robot, move in messages(small_run.log, "move") if move.blocked}
    assert blocked_s == {RULES.blocked_move_s}


@pytest.mark.long
def test_the_fast_model_agrees_with_the_full_simulation(
    durations: dict[Kind, list[float]], tmp_path: Path
) -> None:
    """Ten learners with the path, 600 moves: time per move, and lengths of greedy paths on the way."""
    robots, moves = 10, 600
    text = experiment_text(learners(robots, given=True), moves, "[simulation]\nprocesses = 2")
    run_server(write_experiment(tmp_path, text), tmp_path / "run", "--seed", "11")
    log = tmp_path / "run" / "trial-000.mcap"
    fast = [SurrogateRobot(durations, RULES, given=True, seed=1, trial=trial) for trial in range(40)]
    for robot in fast:
        robot.run(moves)
    seconds = [move.duration_s for _, move in messages(log, "move") if not move.blocked]
    assert np.mean(seconds) == pytest.approx(np.mean([np.mean(robot.seconds) for robot in fast]), rel=0.05)
    lengths = [
        [best.length for robot, best in messages(log, "best_path") if robot == f"r{number}"]
        for number in range(robots)
    ]
    full = np.array([each[: moves // 10] for each in lengths]).mean(axis=1)
    model = np.array([list(robot.best_paths.values()) for robot in fast]).mean(axis=1)
    spread = float(np.hypot(full.std(ddof=1) / robots**0.5, model.std(ddof=1) / len(fast) ** 0.5))
    assert abs(full.mean() - model.mean()) < 3 * spread, (full.mean(), model.mean(), spread)
