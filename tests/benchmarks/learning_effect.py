"""Figure 25's effect: what a path of five SE moves does to learning on a robot.

A small full simulation gives the durations of moves; the same learner then makes 15,000 moves a trial on
them. `python -m tests.benchmarks.learning_effect [--trials N]` prints one JSON line: the mean greedy path by
condition and move with half its 95 % interval, and when the mean first comes down to 12.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from swarm.config.experiment import LearningSettings
from tests.support.fast_moves import Kind, SurrogateRobot, durations_in
from tests.support.swarm_runs import experiment_text, learners, run_server, write_experiment

MOVES = 15_000
TRIALS = 40
SHOWN = (500, 1000, 1500, 2000, 3000, 4000, 6000, 8000, 10_000, 12_000, 15_000)
LENGTH = 12.0
"""The paper's effect: at most this by move 1,500 with the path, still above it at move 8,000 without."""


def measured_durations(moves: int = 150, robots: int = 6) -> dict[Kind, list[float]]:
    """Durations of moves in a full simulation."""
    with tempfile.TemporaryDirectory() as directory:
        text = experiment_text(learners(robots), moves, "[simulation]\nprocesses = 2")
        run_server(write_experiment(Path(directory), text), Path(directory) / "run")
        return durations_in(Path(directory) / "run" / "trial-000.mcap")


def curves(
    durations: dict[Kind, list[float]], rules: LearningSettings, trials: int, moves: int, *, given: bool
) -> tuple[list[int], np.ndarray]:
    """The moves of evaluation, and the greedy path lengths (trial, evaluation)."""
    lengths = []
    for trial in range(trials):
        robot = SurrogateRobot(durations, rules, given=given, seed=1, trial=trial)
        robot.run(moves)
        lengths.append(list(robot.best_paths.values()))
    return list(robot.best_paths), np.array(lengths)


def effect(
    durations: dict[Kind, list[float]], rules: LearningSettings, trials: int, moves: int
) -> dict[str, Any]:
    """Mean greedy path lengths, half their 95 % intervals, and when they come down to 12."""
    result: dict[str, Any] = {"trials": trials, "moves": moves}
    for name, given in (("with_path", True), ("without", False)):
        at, lengths = curves(durations, rules, trials, moves, given=given)
        mean = dict(zip(at, lengths.mean(axis=0).tolist(), strict=True))
        half = dict(zip(at, (1.96 * lengths.std(axis=0, ddof=1) / trials**0.5).tolist(), strict=True))
        result[name] = {
            "mean": {
                str(move): [round(mean[move], 2), round(half[move], 2)] for move in SHOWN if move in mean
            },
            "first_mean_at_most_12": next((move for move in at if mean[move] <= LENGTH), None),
        }
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=TRIALS)
    parser.add_argument("--moves", type=int, default=MOVES)
    arguments = parser.parse_args()
    durations = measured_durations()
    began_s = time.process_time()
    result = effect(durations, LearningSettings(), arguments.trials, arguments.moves)
    moves_made = 2 * arguments.trials * arguments.moves
    result["us_per_move"] = round(1e6 * (time.process_time() - began_s) / moves_made, 1)
    result["mean_move_s"] = round(float(np.mean([s for seen in durations.values() for s in seen])), 2)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
