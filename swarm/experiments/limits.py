"""What fits: refuses sizes that no results could come of, before anything is run."""

from __future__ import annotations

import os
from collections.abc import Mapping

from swarm.errors import UserError
from swarm.experiments.store import RunStore
from swarm.gridworld.condition import Condition

BYTES_A_VALUE = 8 * 3
"""A value of a curve as it is read, averaged over learners and tested."""
BYTES_A_RUN = 100_000
"""What a run costs apart from its curve: its file, its task and its place in tests."""


def check_sizes(store: RunStore, runs_of: Mapping[Condition, int], jobs: int) -> None:
    """UserError if so many runs of these conditions leave no points, or more than the memory holds."""
    needed = 0
    for condition, runs in runs_of.items():
        cut = store.condition(condition)
        if cut.point_limit < 1:
            raise UserError(
                f"--steps {cut.steps} is too short: the best path of {cut.name} is evaluated every "
                f"{cut.evaluate_every} steps; give at least that many"
            )
        needed += BYTES_A_VALUE * cut.point_limit * (runs + 2 * jobs) + BYTES_A_RUN * runs
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > memory:
        raise UserError(
            f"so many runs and steps would need {needed / 1e9:,.1f} GB of memory, and this machine has "
            f"{memory / 1e9:,.1f} GB; give fewer --runs or --steps"
        )
