"""Which tracking systems there are: those that ship, and the entry points of the group `swarm.trackers`."""

from __future__ import annotations

from swarm.errors import UserError, nearest
from swarm.plugins import TRACKERS, plugins
from tracker_bridge.backends.interface import TrackingSystem


def system_named(name: str) -> TrackingSystem:
    """The tracking system that `[tracker] backend` names; UserError lists what there is."""
    known = plugins(TRACKERS)
    if name not in known:
        there_is = ", ".join(sorted(known))
        raise UserError(f"[tracker] backend is {name!r}; {nearest(name, known)} (there is: {there_is})")
    system = known[name].load()
    if not isinstance(system, TrackingSystem):
        raise UserError(f"the entry {known[name].value!r} of {TRACKERS} is no TrackingSystem")
    return system
