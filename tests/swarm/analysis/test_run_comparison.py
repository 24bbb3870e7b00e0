"""Runs side by side: every two conditions of all runs, and a level that holds for all of them together."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from swarm.analysis.run_comparison import RunComparison, compare_runs
from swarm.cli.app import app
from swarm.errors import UserError
from swarm.statistics.multiple_tests import holm
from tests.support.small_logs import learning_log

TRIALS = 8


def made_run(place: Path, shift: int, seed: int) -> Path:
    """Two learners in each trial; the imitator's path is shorter by `shift` moves."""
    place.mkdir()
    noise = np.random.default_rng(seed).integers(-3, 4, size=(TRIALS, 2, 20))
    for trial in range(TRIALS):
        imitator, loner = ([50 + int(value) for value in row] for row in noise[trial])
        curves = {"imitator": [length - shift for length in imitator], "loner": loner}
        learning_log(place / f"trial-{trial:03}.mcap", curves, trial)
    return place


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> RunComparison:
    """Two runs of one experiment, of which in the second imitation helps."""
    place = tmp_path_factory.mktemp("runs")
    return compare_runs([made_run(place / "without", 0, 1), made_run(place / "with", 20, 2)])[0]


def test_every_two_conditions_of_all_runs_are_tested(found: RunComparison) -> None:
    assert list(found.curves.curves) == [
        "without: imitation",
        "without: no-imitation",
        "with: imitation",
        "with: no-imitation",
    ]
    assert len(found.pairs) == 6
    assert not found.untested


def test_what_differs_is_found_and_nothing_else(found: RunComparison) -> None:
    differing = {(pair.comparison.first, pair.comparison.second) for pair in found.pairs if pair.differs}
    assert differing == {
        ("without: imitation", "with: imitation"),
        ("without: no-imitation", "with: imitation"),
        ("with: imitation", "with: no-imitation"),
    }
    for pair in found.pairs:
        assert pair.p >= pair.comparison.p
        assert pair.differs == bool(pair.comparison.family_wise_windows)
    helped = next(pair for pair in found.pairs if pair.comparison.first == "without: imitation")
    assert helped.comparison.pairs == TRIALS


def test_holm_s_own_example() -> None:
    """Four tests; the adjusted values by hand: 4, 3, 2 and 1 times, and none less than the one before."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([]) == []
    assert holm([0.6, 0.7]) == [1.0, 1.0]


def test_no_difference_is_rarely_called_one() -> None:
    """Of 2,000 families of ten tests without a difference at most 5 % have a finding, by three errors."""
    rng = np.random.default_rng(4)
    false = sum(min(holm(list(family))) <= 0.05 for family in rng.uniform(size=(2000, 10)))
    assert false <= 2000 * 0.05 + 3 * (2000 * 0.05 * 0.95) ** 0.5
    assert false > 0


def test_runs_of_other_seeds_say_why_they_are_not_tested(tmp_path: Path) -> None:
    for name, seed in (("one", 1), ("other", 2)):
        (tmp_path / name).mkdir()
        learning_log(tmp_path / name / "trial-000.mcap", {"imitator": [9, 9]}, seed=seed)
    found, _ = compare_runs([tmp_path / "one", tmp_path / "other"])
    assert not found.pairs
    assert "run both with the same seeds" in found.untested[0].reason
    with pytest.raises(UserError, match="name two or more"):
        compare_runs([tmp_path / "one"])


def test_the_command_writes_picture_table_and_report(tmp_path: Path) -> None:
    runs = [str(made_run(tmp_path / name, shift, 3 + shift)) for name, shift in (("a", 0), ("b", 9))]
    out = tmp_path / "out"
    said = json.loads(CliRunner().invoke(app, ["compare", *runs, "--out", str(out), "--json"]).output)
    assert {pair["differs"] for pair in said["pairs"]} == {True, False}
    names = sorted(path.name for path in out.iterdir())
    assert names == ["curves.csv", "curves.png", "inputs.json", "report.md"]
    shown = CliRunner().invoke(app, ["compare", *runs, "--out", str(out)]).output
    assert "a: imitation minus b: imitation, 8 pairs" in shown.replace("\n", " ")
