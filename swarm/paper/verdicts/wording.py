"""Comparisons and times in words."""

from __future__ import annotations

from swarm.gridworld.condition import Condition
from swarm.paper.claim import (
    Better,
    Check,
    ChosenMore,
    CloserPairs,
    Converged,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    Joins,
    MuchSmallerLoss,
    NoDifference,
    PortionsTested,
    ShortestPathMoves,
)
from swarm.statistics.paired_tests import Window


def compared(check: Check) -> str:
    """What is compared with what, and when."""
    match check:
        case Better(good, bad):
            return f"{named(good)} better than {named(bad)}{_when(check)}{_how_much(check)}"
        case NoDifference(first, second):
            return f"{named(first)} no different from {named(second)}"
        case Joins(one, others, step):
            return f"{named(one)} the same as {' and '.join(map(named, others))} from {in_steps(step)} on"
        case MuchSmallerLoss(condition, than):
            return f"{named(condition)} loses at most half of what {named(than)} loses"
        case CloserPairs(condition, than):
            return f"the two of {named(condition)} closer to each other than those of {named(than)}"
        case FindsShortestSooner(sooner, later, part):
            how = "sooner than" if part == 1 else f"in at most {part:.0%} of the time of"
            return f"{named(sooner)} finds the shortest path {how} {named(later)}"
        case FindsShortestBy(condition, step):
            return f"{named(condition)} has found the shortest path by {in_steps(step)}"
        case HigherRatio(_, higher, lower):
            return f"R of {higher.name} above those of {', '.join(move.name for move in lower)}"
        case ChosenMore(_, more, less):
            return f"{more.name} replayed more often than {', '.join(move.name for move in less)}"
        case Converged(condition, tolerance):
            return f"every Q value of {named(condition)} within {tolerance:g} of its final one"
        case PortionsTested(condition, portions):
            return f"{named(condition)} tests about {portions:,} portions"
        case ShortestPathMoves(arena, moves):
            return f"shortest paths on {arena.name}: {', '.join(f'{n} {move.name}' for move, n in moves)}"


def named(condition: Condition) -> str:
    """A condition's name as words."""
    return condition.name.replace("_", " ")


def in_steps(steps: float) -> str:
    """15.5m as the paper writes 15,500,000; smaller numbers in full."""
    return f"{steps / 1e6:.1f}m" if steps >= 1e5 else f"{steps:,.0f}"


def in_windows(windows: tuple[Window, ...]) -> str:
    """Windows of time, or none."""
    return ", ".join(f"{in_steps(window.start)}-{in_steps(window.end)}" for window in windows) or "none"


def _when(check: Better) -> str:
    start = "" if check.start_step is None else f" from {in_steps(check.start_step)}"
    end = "" if check.end_step is None else f" until {in_steps(check.end_step)}"
    return start + end + (" over the whole run" if check.whole_run else "")


def _how_much(check: Better) -> str:
    return "" if check.at_most_moves is None else f", by at most {check.at_most_moves:g} moves"
