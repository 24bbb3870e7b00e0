"""Equations 2 to 6 against values worked out by hand."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from swarm.geometry import Move
from swarm.learning.memory import Approach, ImitationMemory, ObservedPath, choose_window

SE, E, S = (ObservedPath((move,) * 5) for move in (Move.SE, Move.E, Move.S))


def test_every_approach_starts_with_a_ratio_of_1() -> None:
    for approach in Approach:
        memory = ImitationMemory(0.5, approach)
        assert memory.ratio(memory.remember(SE)) == 1.0
        assert memory.p_imitate(memory.remembered[0]) == 0.5


@pytest.mark.parametrize(
    ("approach", "ratio"),
    [(Approach.FIXED, 1.0), (Approach.COMPLETION, 6 / 10), (Approach.AVERAGE_Q, 3 / 10)],
)
def test_ratio_after_nine_replays(approach: Approach, ratio: float) -> None:
    """Five completed, two that raised Q: (5 + 1) / (9 + 1) by eq. 2 and (2 + 1) / (9 + 1) by eq. 4."""
    memory = ImitationMemory(0.4, approach)
    remembered = memory.remember(SE)
    remembered.n_replicated, remembered.n_completed, remembered.n_q_plus = 9, 5, 2
    assert memory.ratio(remembered) == pytest.approx(ratio)
    assert memory.p_imitate(remembered) == pytest.approx(0.4 * ratio)


def test_p_choose_of_equation_5() -> None:
    """Ratios 1, 1/2 and 1/4 are chosen in 4/7, 2/7 and 1/7 of the draws."""
    memory = ImitationMemory(0.5)
    for path, n_replicated in ((SE, 0), (E, 1), (S, 3)):
        memory.remember(path).n_replicated = n_replicated
    rng, draws = np.random.default_rng(5), 7000
    counts = Counter(memory.choose(rng).path for _ in range(draws))
    for path, share in ((SE, 4 / 7), (E, 2 / 7), (S, 1 / 7)):
        assert abs(counts[path] - share * draws) < 4 * math.sqrt(share * (1 - share) * draws)


def test_a_full_memory_forgets_the_path_of_the_lowest_ratio() -> None:
    memory = ImitationMemory(0.5, capacity=3)
    for path, n_replicated in ((SE, 4), (E, 9), (S, 4)):
        memory.remember(path).n_replicated = n_replicated
    assert memory.full
    memory.remember(ObservedPath((Move.N,)))
    assert [str(entry.path) for entry in memory.remembered] == [str(SE), str(S), "N"]


def test_of_equal_ratios_the_oldest_is_forgotten() -> None:
    memory = ImitationMemory(0.5, capacity=2)
    for path in (SE, E, S):
        memory.remember(path)
    assert [entry.path for entry in memory.remembered] == [E, S]


def test_a_path_is_parsed_from_compass_names() -> None:
    assert ObservedPath.parse(["SE", "E"]).moves == (Move.SE, Move.E)
    with pytest.raises(ValueError, match=r"\['SX'\]"):
        ObservedPath.parse(["SE", "SX"])
    with pytest.raises(ValueError, match="none"):
        ObservedPath.parse([])


def test_a_window_of_a_longer_track() -> None:
    rng, moves = np.random.default_rng(1), (*Move, Move.E)
    windows = {choose_window(moves, 5, rng) for _ in range(200)}
    assert windows == {moves[first : first + 5] for first in range(5)}
    assert choose_window((Move.S, Move.W), 5, rng) == (Move.S, Move.W)
    assert choose_window((), 5, rng) == ()
