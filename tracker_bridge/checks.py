"""What has to be right before the tracker bridge starts.

`swarm doctor` and the server find this by its place in `swarm.plugins`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from swarm.checkup.finding import Finding, bad, good
from swarm.config.experiment import Experiment
from swarm.errors import nearest
from swarm.plugins import TRACKERS, plugins
from tracker_bridge.arena_frame import parsed_axes


def checks(experiment: Experiment) -> Iterator[Finding]:
    """About the tracking system, its file and its axes."""
    yield _system(experiment)
    yield from _file(experiment.tracker.file)
    yield _axes(experiment.tracker.axes)


def _system(experiment: Experiment) -> Finding:
    name, known = experiment.tracker.backend, plugins(TRACKERS)
    if name in known:
        return good("tracker", name)
    key = ("tracker", "backend")
    return bad("tracker", f"there is no tracking system {name!r}", nearest(name, known), key)


def _file(name: str) -> Iterator[Finding]:
    """What is in it, the system itself says: each has files of its own."""
    about = "tracker's file"
    if name and not Path(name).is_file():
        yield bad(about, f"{name}: there is no such file", "", ("tracker", "file"))
    elif name:
        yield good(about, name)


def _axes(text: str) -> Finding:
    about = "tracker's axes"
    try:
        parsed_axes(text)
    except ValueError as error:
        return bad(about, str(error), "", ("tracker", "axes"))
    return good(about, text)
