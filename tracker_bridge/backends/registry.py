"""Which tracking systems there are: the entry points of the group `swarm.trackers`, of any package."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from swarm.errors import UserError, nearest
from tracker_bridge.backends.interface import TrackingSystem

GROUP = "swarm.trackers"


def system_named(name: str) -> TrackingSystem:
    """The tracking system that `[tracker] backend` names; UserError lists what there is."""
    known = _known()
    if not known:
        raise UserError(f"no tracking system is installed ({GROUP} is empty): install this package again")
    if name not in known:
        there_is = ", ".join(sorted(known))
        raise UserError(f"[tracker] backend is {name!r}; {nearest(name, known)} (there is: {there_is})")
    system = known[name].load()
    if not isinstance(system, TrackingSystem):
        raise UserError(f"the entry {known[name].value!r} of {GROUP} is no TrackingSystem")
    return system


def _known() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}
