"""Section 3's claims and its study: ways to copy, enactments, and the command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from swarm.cli import section_3
from swarm.config.experiment import Experiment
from swarm.geometry import Move
from swarm.learning.alignment import edit_distance
from swarm.surrogate.copies import CopyPair, CopyStore
from swarm.surrogate.durations import MEASURED_DURATIONS
from swarm.surrogate.enactment import rank_correlations, share_of_imperfect, usefulness
from swarm.surrogate.mutations import RandomEdits, Shuffled, TrueCopies
from swarm.surrogate.trial import CopiedPath, EnactedPath
from tests.support.swarm_runs import ROOT

PAPERS_COPIES = ROOT / "swarm" / "surrogate" / "data" / "paper.csv"
SHOWN = (Move.SE,) * 5


def path(enacted: int, ratio: float, copied: tuple[Move, ...] = SHOWN) -> EnactedPath:
    return EnactedPath(CopiedPath("robot", 0, SHOWN, copied), enacted, ratio)


def test_random_edits_are_as_many_as_the_robots() -> None:
    wrong = CopyStore((CopyPair("random", SHOWN, (Move.SE, Move.E, Move.SE, Move.S, Move.SE)),))
    rng = np.random.default_rng(1)
    found = [RandomEdits(wrong).drawn(SHOWN, rng) for _ in range(200)]
    assert {edit_distance(copied, SHOWN) for copied in found} == {2}
    assert len({len(copied) for copied in found}) > 3
    true = CopyStore((CopyPair("random", SHOWN, SHOWN),))
    assert RandomEdits(true).drawn(SHOWN, rng) == SHOWN


def test_shuffled_lists_have_nothing_to_do_with_what_is_shown() -> None:
    lists = ((Move.N,) * 5, (Move.W,) * 5)
    rng = np.random.default_rng(1)
    assert {Shuffled(lists).drawn(SHOWN, rng) for _ in range(20)} == set(lists)
    assert TrueCopies().drawn(SHOWN, rng) == SHOWN


def test_usefulness_is_progress_to_the_goals_corner() -> None:
    assert usefulness(SHOWN) == 1
    assert usefulness((Move.NW, Move.SE)) == 0
    assert usefulness((Move.E, Move.S)) == 0.5


def test_ratios_are_ranked_within_each_memory() -> None:
    memories = [[path(9, 0.9), path(5, 0.5), path(1, 0.1)], [path(1, 0.9), path(2, 0.1)], [path(1, 0.5)]]
    np.testing.assert_allclose(rank_correlations(memories, "enacted"), [1.0, -1.0])


@pytest.mark.parametrize(("enacted", "significant"), [(90, True), (25, False)])
def test_imperfect_copies_that_are_favoured_are_found(enacted: int, significant: bool) -> None:
    imperfect = path(enacted, 0.5, (Move.E,) * 5)
    memories = [[imperfect, path(25, 0.5), path(25, 0.5), path(25, 0.5)] for _ in range(10)]
    share = share_of_imperfect(memories, np.random.default_rng(1))
    assert share is not None
    assert share.expected == 0.25
    assert share.enacted == pytest.approx(enacted / (75 + enacted))
    assert (share.p <= 0.05) is significant


def test_a_memory_of_one_kind_says_nothing() -> None:
    assert share_of_imperfect([[path(3, 0.5), path(4, 0.5)]], np.random.default_rng(1)) is None


def asked(moves: int, trials: int) -> section_3.AskedTrials:
    folder = ROOT / "deploy" / "sim"
    expert, each_other = (
        Experiment.load(folder / name).changed(moves=moves) for name in ("expert.toml", "each-other.toml")
    )
    return section_3.AskedTrials((expert, each_other), PAPERS_COPIES, MEASURED_DURATIONS, trials, 1)


def test_every_claim_of_section_3_is_judged(tmp_path: Path) -> None:
    result = section_3.judged_claims(asked(1000, 4), tmp_path)
    assert {claim["section"] for claim in result["claims"]} == {"3.4.1", "3.4.2", "3.5"}
    page = (tmp_path / "claims.md").read_text()
    assert all(claim["text"] in page for claim in result["claims"])
    verdicts = {claim["verdict"] for claim in result["claims"]}
    assert "does not hold" not in verdicts, "four trials show no absence"
    assert any("of the copies are wrong" in line for line in section_3.lines(result))


def test_every_arm_of_every_task_is_studied(tmp_path: Path) -> None:
    result = section_3.studied_errors(asked(600, 3), tmp_path)
    assert len(result["arms"]) == 3 * 4
    for arm in result["arms"]:
        if arm["arm"] == "true copies":
            assert arm["gain_moves"] == 0
            assert not arm["benefits"]
    assert "edge teacher" in (tmp_path / "embodiment.md").read_text()
