"""Section 2.3: an agent that is given eight paths on the 100 x 100 arena (figures 10 to 14)."""

from __future__ import annotations

from dataclasses import replace

from swarm.geometry import Grid, Move
from swarm.gridworld.arena import OBSTACLE_100
from swarm.paper.claim import Better, ChosenMore, Claim, HigherRatio, ShortestPathMoves
from swarm.paper.conditions import EIGHT_PATHS, GIVEN_EIGHT_PATHS, NO_IMITATION, large_study
from swarm.paper.study import Drawing, Shown, Study

USELESS = (Move.SW, Move.W, Move.NW, Move.N, Move.NE)


def figure_10() -> Drawing:
    """The 100 x 100 arena with an obstacle in the middle."""
    return Drawing("fig10", "Arena with obstacle", OBSTACLE_100.grid)


def figure_11() -> Drawing:
    """The eight paths given to the agent."""
    paths = {path.moves[0].name: ((20, 20), path.moves) for path in EIGHT_PATHS}
    return Drawing("fig11", "8 paths given to the agent", Grid(41, 41), paths, marks_ends=False)


def figure_12() -> Study:
    """An agent that is given eight paths."""
    series = {
        "no imitation": NO_IMITATION,
        "8 paths given": GIVEN_EIGHT_PATHS,
    }
    return large_study(
        "fig12",
        "Best path length for imitating (8 paths given) and no-imitation agents",
        series,
        interval_points=10,
        claims=_claims_of_12(),
    )


def _claims_of_12() -> tuple[Claim, ...]:
    return (
        Claim(
            "The imitation-enhanced learning agent was able to choose the beneficial paths and improve "
            "its performance. A pair-wise t-test reveals that the difference between the two is "
            "statistically significant until around time step 15.5m.",
            (Better(GIVEN_EIGHT_PATHS, NO_IMITATION, end_step=15_500_000),),
        ),
    )


def figure_13() -> Drawing:
    """An example shortest path, the one that the expert follows."""
    path = {"shortest path": ((0, 0), OBSTACLE_100.expert_path)}
    return Drawing(
        "fig13", "An example shortest path to the goal state", OBSTACLE_100.grid, path, claims=_claims_of_13()
    )


def _claims_of_13() -> tuple[Claim, ...]:
    return (
        Claim(
            "Any shortest path consists of a combination of 80 moves to SE, 20 moves to S and 20 moves "
            "to E directions.",
            (ShortestPathMoves(OBSTACLE_100, ((Move.SE, 80), (Move.S, 20), (Move.E, 20))),),
        ),
    )


def figure_14() -> Study:
    """What became of the eight paths."""
    title = "The R values for each path given to the agent"
    study = large_study("fig14", title, {"8 paths given": GIVEN_EIGHT_PATHS}, claims=_claims_of_14())
    return replace(study, shown=Shown.RATIOS)


def _claims_of_14() -> tuple[Claim, ...]:
    others = tuple(move for move in Move if move is not Move.SE)
    return (
        Claim(
            "As can be seen, the path to the SE has the highest R_i value which makes it more likely to "
            "be chosen.",
            (HigherRatio(GIVEN_EIGHT_PATHS, Move.SE, others),),
        ),
        Claim(
            "The paths E and S have relatively higher R_i values compared to the other 5 paths.",
            tuple(HigherRatio(GIVEN_EIGHT_PATHS, move, USELESS) for move in (Move.E, Move.S)),
        ),
        Claim(
            "This confirms that the agent was able to select the 3 paths that are more likely to improve its "
            "performance.",
            tuple(ChosenMore(GIVEN_EIGHT_PATHS, move, USELESS) for move in (Move.SE, Move.E, Move.S)),
        ),
    )
