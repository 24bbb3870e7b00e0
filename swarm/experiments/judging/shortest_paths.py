"""Of which moves an arena's shortest paths consist: counted, not tested."""

from __future__ import annotations

from swarm.experiments.claim import ShortestPathMoves
from swarm.experiments.judging.finding import Finding, Verdict
from swarm.experiments.judging.wording import compared
from swarm.geometry import Move
from swarm.gridworld.arena import Arena, distances, neighbours


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
