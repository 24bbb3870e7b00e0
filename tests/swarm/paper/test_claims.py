"""`swarm claims`: verdicts on curves made to hold, to fail and to be too few; and the command's reports."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swarm.cli.claims import judge_claims
from swarm.errors import UserError
from swarm.geometry import Grid, Move
from swarm.gridworld.arena import OBSTACLE_100, Arena
from swarm.gridworld.condition import Condition
from swarm.paper.claim import (
    Better,
    Check,
    Claim,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    NoDifference,
    ShortestPathMoves,
)
from swarm.paper.conditions import GIVEN_EIGHT_PATHS, SMALL_NO_IMITATION
from swarm.paper.results import Results
from swarm.paper.store import open_store
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.facts import move_range, shortest_path_moves
from swarm.paper.verdicts.finding import Finding, Verdict, combined
from swarm.paper.verdicts.judge import judge
from tests.support.traces import made_up_trace

END = 2000
SLOW = replace(SMALL_NO_IMITATION, name="slow", goal_reachings=None, steps=END, points=None)
QUICK = replace(SLOW, name="quick")
PATHS = replace(SLOW, name="paths", teacher=GIVEN_EIGHT_PATHS.teacher)
POINTS = SLOW.point_limit


def arriving(step: float, runs: int, seed: int) -> np.ndarray:
    """Curves that fall from 100 to 9 at about `step`, each at its own time."""
    times = np.random.default_rng(seed).normal(step, 60, size=(runs, 1))
    return np.where(10 * np.arange(1, POINTS + 1) < times, 100, 9)


def evidence(folder: Path, curves: dict[Condition, np.ndarray], ratios: np.ndarray | None = None) -> Evidence:
    """Results on the disk, as if these curves had been run."""
    store = open_store(folder, seed=1, steps=None)
    for condition, rows in curves.items():
        store.admit(condition)
        for run, row in enumerate(rows):
            r = np.ones((1, 1)) if ratios is None else ratios[run : run + 1]
            store.save(condition, run, made_up_trace(row[None].astype(np.int32), r, END))
    return Evidence(Results(store, min(map(len, curves.values()))), END)


def found(check: Check, seen: Evidence) -> Finding:
    return judge("fig0", Claim("", (check,)), seen).findings[0]


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Evidence:
    curves = {SLOW: arriving(1500, 100, seed=1), QUICK: arriving(500, 100, seed=2)}
    return evidence(tmp_path_factory.mktemp("many"), curves)


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> Evidence:
    curves = {SLOW: arriving(1500, 4, seed=1), QUICK: arriving(500, 4, seed=2)}
    return evidence(tmp_path_factory.mktemp("few"), curves)


@pytest.fixture(scope="module")
def same(tmp_path_factory: pytest.TempPathFactory) -> Evidence:
    curves = {SLOW: arriving(1000, 100, seed=3), QUICK: arriving(1000, 100, seed=4)}
    return evidence(tmp_path_factory.mktemp("same"), curves)


@pytest.mark.parametrize(
    ("check", "verdict"),
    [
        (Better(QUICK, SLOW), Verdict.HOLDS),
        (Better(QUICK, SLOW, 400, 1600, rounded_steps=100), Verdict.HOLDS),
        (Better(QUICK, SLOW, None, 1600, rounded_steps=100), Verdict.HOLDS),
        (Better(QUICK, SLOW, 400, 1200, rounded_steps=100), Verdict.IN_PART),
        (Better(QUICK, SLOW, 1000, 1600, rounded_steps=100), Verdict.IN_PART),
        (Better(QUICK, SLOW, None, 2500, rounded_steps=100), Verdict.UNDECIDED),
        (Better(SLOW, QUICK), Verdict.DOES_NOT_HOLD),
        (NoDifference(SLOW, QUICK, 1.0), Verdict.DOES_NOT_HOLD),
        (FindsShortestSooner(QUICK, SLOW), Verdict.HOLDS),
        (FindsShortestSooner(SLOW, QUICK), Verdict.DOES_NOT_HOLD),
        (FindsShortestBy(QUICK, 600), Verdict.HOLDS),
        (FindsShortestBy(SLOW, 600), Verdict.DOES_NOT_HOLD),
    ],
)
def test_what_a_hundred_clear_runs_decide(many: Evidence, check: Check, verdict: Verdict) -> None:
    assert found(check, many).verdict is verdict


def test_a_finding_shows_both_tests_and_the_effect(many: Evidence) -> None:
    finding = found(Better(QUICK, SLOW, 600, 1400), many)
    for test in (finding.paper_test, finding.family_wise_test):
        assert test is not None
        (window,) = test.windows
        assert 300 <= window.start <= 500
        assert 1500 <= window.end <= 1700
        assert not test.against
    assert finding.effect is not None
    assert finding.effect.mean_difference == pytest.approx(91, rel=0.02)
    assert finding.effect.mean_interval[0] > 80


@pytest.mark.parametrize(
    "check", [Better(QUICK, SLOW), NoDifference(QUICK, SLOW, 1.0), FindsShortestSooner(QUICK, SLOW)]
)
def test_four_runs_decide_nothing(few: Evidence, check: Check) -> None:
    assert found(check, few).verdict is Verdict.UNDECIDED


def test_a_test_that_cannot_be_made_is_undecided_with_its_reason(tmp_path: Path) -> None:
    alone = evidence(tmp_path, {SLOW: arriving(1500, 1, 1), QUICK: arriving(500, 1, 2)})
    finding = found(Better(QUICK, SLOW), alone)
    assert finding.verdict is Verdict.UNDECIDED
    assert "at least 2 are needed" in finding.why


def test_where_there_is_no_difference(same: Evidence) -> None:
    assert found(Better(QUICK, SLOW), same).verdict is Verdict.DOES_NOT_HOLD
    assert found(FindsShortestSooner(QUICK, SLOW), same).verdict is Verdict.DOES_NOT_HOLD
    assert found(NoDifference(QUICK, SLOW, 1.0), same).verdict in (Verdict.HOLDS, Verdict.IN_PART)


def test_better_at_first_and_worse_for_longer_holds_in_part(tmp_path: Path) -> None:
    settles_high = np.maximum(arriving(300, 100, seed=5), 12)
    seen = evidence(tmp_path, {QUICK: settles_high, SLOW: arriving(800, 100, seed=6)})
    finding = found(Better(QUICK, SLOW), seen)
    assert finding.verdict is Verdict.IN_PART
    assert finding.why == "better on average, but worse for longer"


def test_the_order_of_ratios(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    means = np.array([0.35, 0.73, 0.35, 0.28, 0.01, 0.01, 0.01, 0.36])  # NE is too high for the claim
    ratios = rng.normal(means, 0.02, size=(100, 8))
    seen = evidence(tmp_path, {PATHS: arriving(500, 100, 1)}, ratios)
    others = tuple(move for move in Move if move is not Move.SE)
    assert found(HigherRatio(PATHS, Move.SE, others), seen).verdict is Verdict.HOLDS
    east = found(HigherRatio(PATHS, Move.E, (Move.SW, Move.W, Move.NE)), seen)
    assert east.verdict is Verdict.IN_PART
    assert "significantly above 2 of 3" in east.why
    assert found(HigherRatio(PATHS, Move.E, (Move.SE,)), seen).verdict is Verdict.DOES_NOT_HOLD


def test_the_moves_of_shortest_paths_are_counted() -> None:
    grid = Arena("strip", Grid(4, 2), (Move.SE, Move.E, Move.E))
    assert move_range(grid, Move.SE) == (1, 2)  # E E SE, or SE NE SE, or ...
    assert move_range(grid, Move.E) == (0, 2)
    assert move_range(grid, Move.W) == (0, 0)
    claimed = ShortestPathMoves(OBSTACLE_100, ((Move.SE, 79), (Move.E, 20), (Move.S, 30)))
    finding = shortest_path_moves(claimed)
    assert finding.verdict is Verdict.DOES_NOT_HOLD
    assert "119 moves" in finding.why


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        ([Verdict.HOLDS, Verdict.HOLDS], Verdict.HOLDS),
        ([Verdict.HOLDS, Verdict.UNDECIDED], Verdict.UNDECIDED),
        ([Verdict.HOLDS, Verdict.DOES_NOT_HOLD], Verdict.IN_PART),
        ([Verdict.DOES_NOT_HOLD, Verdict.UNDECIDED], Verdict.IN_PART),
        ([Verdict.DOES_NOT_HOLD], Verdict.DOES_NOT_HOLD),
    ],
)
def test_a_claim_needs_all_its_comparisons(verdicts: list[Verdict], expected: Verdict) -> None:
    assert combined(verdicts) is expected


@pytest.fixture(scope="module")
def small_report(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], list[str]]:
    out = tmp_path_factory.mktemp("claims")
    return judge_claims(["3", "13"], "swarm claims 3 13", runs=12, steps=3000, seed=1, out=out)


def test_the_command_judges_and_reports(small_report: tuple[dict[str, Any], list[str]]) -> None:
    result, lines = small_report
    assert [claim["figure"] for claim in result["claims"]] == ["fig3", "fig3", "fig3", "fig13"]
    gain = result["claims"][1]
    assert gain["text"].startswith("As can be expected, there is a performance increase")
    assert gain["verdict"] == "holds"
    assert len(gain["comparisons"]) == 3
    assert {"paper_test", "family_wise_test", "effect", "why"} <= set(gain["comparisons"][0])
    assert result["claims"][3]["verdict"] == "holds in part"
    assert lines[4].startswith("4 claims; holds: ")
    json.dumps(result, allow_nan=False)


def test_the_reports_hold_every_claim(small_report: tuple[dict[str, Any], list[str]]) -> None:
    result, _ = small_report
    markdown, html = (Path(result["files"][form]).read_text() for form in ("markdown", "html"))
    for claim in result["claims"]:
        assert claim["text"] in markdown
        assert claim["verdict"] in markdown
        assert claim["text"] in html
    assert "`swarm claims 3 13`" in markdown
    assert html.count("data:image/png;base64,") == 1
    assert json.loads(Path(result["files"]["json"]).read_text())["claims"] == result["claims"]


def test_a_figure_without_claims_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no claim that can be checked about fig1"):
        judge_claims(["fig1"], "", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_verdicts_do_not_depend_on_the_number_of_workers(
    small_report: tuple[dict[str, Any], list[str]], tmp_path: Path
) -> None:
    again, _ = judge_claims(["fig3", "fig13"], "", runs=12, steps=3000, seed=1, out=tmp_path, jobs=2)
    assert again["claims"] == small_report[0]["claims"]


USERS_STUDY = """
from swarm.gridworld.arena import OPEN_10
from swarm.gridworld.condition import Condition, GivenPaths, NoTeacher
from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import BENEFICIAL
from swarm.paper.study import Study

def condition(name, teacher):
    return Condition(name, OPEN_10, teacher, epsilon=0.3, steps=2_000, evaluate_every=10)

def figure():
    alone, given = condition("alone", NoTeacher()), condition("given", GivenPaths((BENEFICIAL,)))
    claims = (Claim("A good path helps.", (Better(given, alone),)),)
    return Study("mine", "Mine", {"a": alone, "b": given}, horizon_steps=2_000, runs=12, claims=claims)
"""


def test_the_claims_of_a_users_study_are_judged(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(USERS_STUDY)
    result, _ = judge_claims([str(tmp_path / "mine.py")], "", out=tmp_path / "out")
    assert [(claim["figure"], claim["verdict"]) for claim in result["claims"]] == [("mine", "holds")]
