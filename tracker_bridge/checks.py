"""What has to be right before the tracker bridge starts.

`swarm doctor` and the server find this by its place in `swarm.plugins`.
"""

from __future__ import annotations

from collections.abc import Iterator

from swarm.checkup.finding import Finding, bad, good
from swarm.config.experiment import Experiment
from swarm.errors import nearest
from swarm.plugins import TRACKERS, plugins


def checks(experiment: Experiment) -> Iterator[Finding]:
    """About the tracking system."""
    name, known = experiment.tracker.backend, plugins(TRACKERS)
    if name in known:
        yield good("tracker", name)
    else:
        key = ("tracker", "backend")
        yield bad("tracker", f"there is no tracking system {name!r}", nearest(name, known), key)
