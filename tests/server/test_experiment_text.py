"""The experiment file of a run: what `--set` changed stands in it, and everything else as it was."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.experiment_text import experiment_bytes
from swarm.config.experiment import Experiment
from tests.support.swarm_runs import ROOT, experiment_text, write_experiment

CHANGES = (
    "learning.epsilon=0.3",
    "run.name=other",
    "run.trials=3",
    "arena.height_m=3.0",
    "robot.expert.south_west_m=[0.0, 1.5]",
    "robot.imitator.watches=expert",
    "robot.imitator.paths=[['SE', 'E'], ['S']]",
    "robot.loner.south_west_m=[2.6, 0.0]",
    "visits.profile=paper",
)


@pytest.mark.parametrize("changes", [CHANGES[:1], CHANGES])
def test_it_says_what_is_run(tmp_path: Path, changes: tuple[str, ...]) -> None:
    file = write_experiment(tmp_path, experiment_text())
    kept = tmp_path / "experiment.toml"
    kept.write_bytes(experiment_bytes(file, changes))
    assert Experiment.load(kept) == Experiment.load(file, changes) != Experiment.load(file)


def test_comments_and_order_stay() -> None:
    file = ROOT / "deploy" / "sim" / "demo.toml"
    before, after = file.read_text(), experiment_bytes(file, ["run.moves=7"]).decode()
    assert after == before.replace("moves = 2000", "moves = 7")


def test_without_a_change_it_is_the_file_byte_for_byte(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(b"# \xc3\xa4\r\n[run]\n")
    assert experiment_bytes(file, []) == file.read_bytes()
