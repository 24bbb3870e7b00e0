"""The score of a learning curve: what was lost while learning, and when the shortest path was found."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from swarm.analysis.curves import Curves


def learning_score(curves: Curves, shortest_moves: float) -> dict[str, float | None]:
    """The mean best path length over the time shown, and when the shortest path was first found.

    Times are in steps: the Kaplan-Meier median (None if fewer than half of the runs found it) and the mean
    up to the end of the curve, in which a run that has not found it counts as the end.
    """
    from swarm.analysis.area import mean_level
    from swarm.analysis.threshold import median_time, restricted_mean_time, times_to_threshold

    arrivals = times_to_threshold(curves, shortest_moves)
    horizon = float(curves.times[-1])
    return {
        "mean_best_path_length": float(mean_level(curves).values.mean()),
        "median_steps_to_shortest": median_time(arrivals),
        "restricted_mean_steps_to_shortest": restricted_mean_time(arrivals, horizon).time,
        "share_of_runs_that_found_it": float(arrivals.observed.mean()),
    }
