"""Checks that need no test: what the arena and the runs are like."""

from __future__ import annotations

import numpy as np

from swarm.geometry import Move
from swarm.gridworld.arena import Arena, distances, neighbours
from swarm.gridworld.state import COPIED, TRIED
from swarm.paper.claim import Converged, PortionsTested, ShortestPathMoves
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared


def converged(check: Converged, evidence: Evidence) -> Finding:
    """The worst Q value of all runs."""
    errors = evidence.results.q_errors(check.condition)
    why = (
        f"the worst Q value is {errors.max():.2g} off, in half of the runs less than {np.median(errors):.2g}"
    )
    verdict = Verdict.HOLDS if errors.max() <= check.tolerance else Verdict.IN_PART
    if np.median(errors) > check.tolerance:
        verdict = Verdict.DOES_NOT_HOLD
    return Finding(compared(check), _of_whole_runs(verdict, evidence), why)


def _of_whole_runs(verdict: Verdict, evidence: Evidence) -> Verdict:
    """Runs that are cut to a number of steps say nothing about their end."""
    return verdict if evidence.results.store.steps is None else Verdict.UNDECIDED


def portions_tested(check: PortionsTested, evidence: Evidence) -> Finding:
    """The mean over runs, within a factor of two: the number of runs up to a time is not given."""
    tally = evidence.results.tally(check.condition).mean(axis=0)
    copied, tested = tally[COPIED], tally[TRIED]
    why = f"{copied:.0f} portions copied on average, {tested:.0f} of them replayed at least once"
    near = check.portions / 2 <= tested <= check.portions * 2
    verdict = Verdict.HOLDS if near else Verdict.DOES_NOT_HOLD
    return Finding(compared(check), _of_whole_runs(verdict, evidence), why)


def shortest_path_moves(check: ShortestPathMoves) -> Finding:
    """The claimed counts against the fewest and most moves in each direction of all shortest paths.

    It holds in part if a shortest path has, but for one move in each direction, the claimed counts.
    """
    ranges = {move: move_range(check.arena, move) for move in Move}
    claimed = dict(check.moves)
    right = [ranges[move] == (claimed.get(move, 0),) * 2 for move in Move]
    shown = ", ".join(f"{_in_words(ranges[move])} {move.name}" for move in Move if ranges[move][1])
    length = distances(check.arena)[check.arena.grid.start]
    why = f"a shortest path has {length} moves: {shown}"
    if all(right):
        return Finding(compared(check), Verdict.HOLDS, why)
    near = all(low - 1 <= claimed.get(move, 0) <= high + 1 for move, (low, high) in ranges.items())
    return Finding(compared(check), Verdict.IN_PART if near else Verdict.DOES_NOT_HOLD, why)


def move_range(arena: Arena, move: Move) -> tuple[int, int]:
    """The fewest and the most moves in one direction that a shortest path can have."""
    to_go, table = distances(arena), neighbours(arena)
    ranges: dict[int, tuple[int, int]] = {arena.grid.goal: (0, 0)}
    states = sorted((state for state in range(arena.grid.states) if to_go[state] > 0), key=to_go.item)
    for state in states:
        onward = [
            (step, ranges[int(entered)])
            for step, entered in enumerate(table[state])
            if to_go[entered] == to_go[state] - 1
        ]
        fewest = min(low + (step == move) for step, (low, _) in onward)
        ranges[state] = fewest, max(high + (step == move) for step, (_, high) in onward)
    return ranges[arena.grid.start]


def _in_words(counts: tuple[int, int]) -> str:
    return str(counts[0]) if counts[0] == counts[1] else f"{counts[0]} to {counts[1]}"
