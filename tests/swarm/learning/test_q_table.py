"""Equations 1 and 7 against values worked out by hand."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from swarm.geometry import Move
from swarm.learning.q_table import ALPHA, GAMMA, QTable, discount_over


def test_first_reward_moves_q_by_alpha() -> None:
    q = QTable(3)
    assert q.update(1, Move.SE, 1.0, 2, GAMMA) == pytest.approx(0.2)
    assert q.values[1] == [0.0, pytest.approx(0.2), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]


def test_equation_1_by_hand() -> None:
    """Q(0, E) = 0.5 and max Q(1, .) = 2: the target is 0.1 + 0.7 * 2 = 1.5, the change 0.2 * (1.5 - 0.5)."""
    q = QTable(2)
    q.values[0][Move.E] = 0.5
    q.values[1][Move.N] = 2.0
    q.values[1][Move.S] = -3.0
    assert q.update(0, Move.E, 0.1, 1, GAMMA) == pytest.approx(0.2)
    assert q.values[0][Move.E] == pytest.approx(0.7)


def test_a_state_that_leads_to_itself_uses_its_own_best_value() -> None:
    """A blocked move: target 0.7 * 1 for Q(0, N) = 0 is a change of 0.14."""
    q = QTable(1)
    q.values[0][Move.E] = 1.0
    assert q.update(0, Move.N, 0.0, 0, GAMMA) == pytest.approx(0.14)


def test_repeated_updates_converge_to_the_target() -> None:
    q = QTable(2)
    for _ in range(10):
        q.update(0, Move.E, 1.0, 1, GAMMA)
    assert q.values[0][Move.E] == pytest.approx(1.0 - (1.0 - ALPHA) ** 10)


def test_discount_of_equation_7() -> None:
    """exp(-0.149 * 2.4) = 0.6993...: the 0.7 of equation 1."""
    assert discount_over(2.4) == pytest.approx(0.69935, abs=1e-5)
    assert discount_over(0.0) == 1.0
    assert discount_over(1.0) * discount_over(1.4) == pytest.approx(discount_over(2.4))
    assert discount_over(3.0, 0.5) == pytest.approx(math.exp(-1.5))


def test_a_longer_move_to_the_same_cell_is_worth_less() -> None:
    quick, slow = QTable(2), QTable(2)
    for q, duration_s in ((quick, 2.0), (slow, 3.0)):
        discount = discount_over(duration_s)
        q.update(0, Move.E, discount * 1.0, 1, discount)
    assert quick.values[0][Move.E] == pytest.approx(0.2 * math.exp(-0.298))
    assert slow.values[0][Move.E] == pytest.approx(0.2 * math.exp(-0.447))


def test_ties_are_broken_at_random_and_evenly() -> None:
    q = QTable(1)
    for action in (Move.SE, Move.W, Move.N):
        q.values[0][action] = 1.0
    assert q.best_actions(0) == [Move.SE, Move.W, Move.N]
    rng = np.random.default_rng(3)
    counts = Counter(q.greedy(0, rng) for _ in range(3000))
    assert set(counts) == {Move.SE, Move.W, Move.N}
    assert all(abs(count - 1000) < 4 * math.sqrt(3000 * 2 / 9) for count in counts.values())


def test_a_single_best_action_draws_no_random_number() -> None:
    q = QTable(1)
    q.values[0][Move.W] = 1.0
    rng = np.random.default_rng(3)
    before = rng.bit_generator.state
    assert q.greedy(0, rng) == Move.W
    assert rng.bit_generator.state == before


def test_only_a_strictly_better_action_counts_as_better() -> None:
    q = QTable(1)
    assert not q.has_better(0, Move.E)
    q.values[0][Move.SE] = 0.1
    assert q.has_better(0, Move.E)
    assert not q.has_better(0, Move.SE)
