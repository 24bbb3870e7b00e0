"""The arenas are those of the paper's figures 1, 10 and 13."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from swarm.geometry import Move
from swarm.gridworld.arena import (
    OBSTACLE_100,
    OPEN_10,
    Arena,
    distances,
    expert_values,
    neighbours,
    offsets,
    ways,
)

ARENAS = pytest.mark.parametrize("arena", [OPEN_10, OBSTACLE_100], ids=lambda arena: arena.name)


@ARENAS
def test_expert_path_is_a_shortest_path(arena: Arena) -> None:
    state = arena.grid.start
    for move in arena.expert_path:
        entered = arena.grid.neighbour(state, move)
        assert entered is not None
        state = entered
    assert state == arena.grid.goal
    assert len(arena.expert_path) == distances(arena)[arena.grid.start]


def test_shortest_paths_have_the_papers_lengths() -> None:
    assert distances(OPEN_10)[0] == 9
    assert distances(OBSTACLE_100)[0] == 119
    assert Counter(OBSTACLE_100.expert_path) == {Move.SE: 79, Move.E: 20, Move.S: 20}


def test_obstacle_is_a_centred_block() -> None:
    grid = OBSTACLE_100.grid
    cells = [grid.cell(state) for state in grid.obstacle]
    assert len(cells) == 20 * 20
    assert {column for column, _ in cells} == {row for _, row in cells} == set(range(40, 60))


@ARENAS
def test_tables_agree_with_the_grid(arena: Arena) -> None:
    grid = arena.grid
    table, open_ways, steps = neighbours(arena), ways(arena), offsets(arena).view(np.int64)
    for state in range(0, grid.states, 7):
        for move in Move:
            entered = grid.neighbour(state, move)
            assert table[state, move] == (state if entered is None else entered)
            assert bool(open_ways[state] >> move & 1) == (entered is not None)
            if entered is not None:
                assert state + steps[move] == entered


@ARENAS
def test_experts_greedy_actions_are_those_that_bring_it_nearer(arena: Arena) -> None:
    values, to_go, table = expert_values(arena, 0.7), distances(arena), neighbours(arena)
    reachable = (to_go > 0) & ~np.isin(np.arange(arena.grid.states), list(arena.grid.obstacle))
    best = values == values.max(axis=1, keepdims=True)
    nearer = to_go[table] == to_go[:, np.newaxis] - 1
    assert np.array_equal(best[reachable], nearer[reachable])
    assert values[arena.grid.start].max() == pytest.approx(0.7 ** (to_go[arena.grid.start] - 1))
