"""The paper's open points: alternatives as data, shared runs, and the grid of verdicts."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.cli.claims import judge_claims
from swarm.errors import UserError
from swarm.gridworld.condition import Precision
from swarm.learning.controller import QIncrease
from swarm.paper.conditions import COPYING_EXPERT, NO_IMITATION, SMALL_NO_IMITATION
from swarm.paper.readings import DEFAULT, OPTIONS, Readings, parse_readings, single_changes
from swarm.paper.store import open_store


def test_the_default_changes_nothing() -> None:
    for condition in (COPYING_EXPERT, NO_IMITATION, SMALL_NO_IMITATION):
        assert DEFAULT.of(condition) == condition


def test_a_reading_changes_only_what_it_is_about() -> None:
    at_once = parse_readings(["first-copy=before-the-first-run"])
    assert at_once.of(COPYING_EXPERT).teacher.copies_at_once  # type: ignore[union-attr]
    assert at_once.of(COPYING_EXPERT).name == "copying_expert@first-copy=before-the-first-run"
    assert at_once.of(NO_IMITATION) == NO_IMITATION
    stored = parse_readings(["q-increase=change-stored", "precision=single", "epsilon-100=0.6"])
    read = stored.of(COPYING_EXPERT)
    assert (read.increase, read.precision, read.epsilon) == (QIncrease.STORED, Precision.SINGLE, 0.6)
    assert stored.of(SMALL_NO_IMITATION).epsilon == 0.3


def test_what_is_read_once_is_read_for_good() -> None:
    for readings in single_changes():
        once = readings.of(COPYING_EXPERT)
        assert readings.of(once) == once


def test_every_alternative_is_tried_once() -> None:
    assert len(single_changes()) == 1 + sum(len(option.alternatives) - 1 for option in OPTIONS)
    assert single_changes()[0] == DEFAULT


def test_runs_that_no_reading_touches_are_shared(tmp_path: Path) -> None:
    plain = open_store(tmp_path, 1, 1000)
    other = open_store(tmp_path, 1, 1000, readings=Readings({"first-copy": "before-the-first-run"}))
    for condition in (NO_IMITATION, COPYING_EXPERT):
        plain.admit(condition)
        other.admit(condition)
    assert len(list((tmp_path / "runs").iterdir())) == 3


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("first-cop=at-once", "did you mean 'first-copy'"),
        ("epsilon-10=0.7", "epsilon-10 can be 0.3, 0.1, 0.5"),
        ("precision", "precision can be double, single"),
    ],
)
def test_a_reading_that_there_is_not_is_refused(words: str, why: str) -> None:
    with pytest.raises(UserError, match=why):
        parse_readings([words])


def test_the_grid_judges_every_claim_under_every_reading(tmp_path: Path) -> None:
    result, lines = judge_claims(["13"], "", grid_runs=2, runs=2, out=tmp_path, jobs=1)
    assert list(result["readings"]) == [readings.label for readings in single_changes()]
    assert result["readings"]["default"] == {"verdicts": ["holds in part"], "hold": 0}
    page = Path(result["files"]["markdown"]).read_text()
    assert "## Under other readings" in page
    assert all(option.place in page for option in OPTIONS)
    assert "default: 0 hold of 2 runs" in lines
