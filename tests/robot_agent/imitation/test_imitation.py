"""The three stages of the imitation in a row, with robots at both ends of real bytes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robot_agent.imitation.copying import NoCopy
from robot_agent.imitation.imitation import Imitation
from robot_agent.imitation.pattern import corner_error_m, seen_pattern, similarity
from swarm.config.experiment import CopyProfile
from tests.support.imitating_pair import ImitatingPair, random_pattern

MOST_CORNER_ERROR_M = 0.05
SQUARE = [(0.0, 0.0), (0.2, 0.0), (0.2, 0.2), (0.0, 0.2)]


@pytest.mark.parametrize(("demonstrator", "observer"), [("serial", "wifi"), ("sim", "sim")])
def test_a_pattern_of_five_segments_is_driven_as_it_was_shown(
    demonstrator: str, observer: str, tmp_path: Path
) -> None:
    rng = np.random.default_rng(11)
    commands, _ = random_pattern(rng)
    pair = ImitatingPair(demonstrator, observer, tmp_path, rng)
    imitated = pair.imitated(commands)
    pair.close()
    assert isinstance(imitated.result, Imitation)
    assert len(imitated.result.segments) == 5
    assert corner_error_m(imitated.shown, imitated.driven) <= MOST_CORNER_ERROR_M
    assert imitated.result.similarity.overall > 0.95


def test_a_demonstrator_that_was_not_seen_gives_no_pattern() -> None:
    assert isinstance(seen_pattern([], CopyProfile.BEST, 100), NoCopy)


def test_equal_patterns_are_equally_similar_wherever_they_lie() -> None:
    moved = [(x_m + 3.0, y_m - 1.0) for x_m, y_m in SQUARE]
    same = similarity(SQUARE, moved)
    assert (same.lengths, same.turns, same.corner_error_m) == pytest.approx((1.0, 1.0, 0.0))


def test_similarity_falls_with_lengths_turns_and_missing_segments() -> None:
    half = [(x_m / 2, y_m / 2) for x_m, y_m in SQUARE]
    assert similarity(SQUARE, half).lengths == pytest.approx(0.5)
    assert similarity(SQUARE, half).turns == pytest.approx(1.0)
    mirrored = [(x_m, -y_m) for x_m, y_m in SQUARE]
    assert similarity(SQUARE, mirrored).turns == pytest.approx(1 / 3)
    shorter = similarity(SQUARE, SQUARE[:-1])
    assert shorter.lengths == pytest.approx(2 / 3)
    assert shorter.corner_error_m == pytest.approx(0.2 / 3)
