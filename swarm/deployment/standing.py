"""How a laboratory's machines stand before a trial: what each of them runs, and what time it has."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from swarm.checkup.finding import Finding, bad, good
from swarm.config.laboratory import Laboratory
from swarm.deployment.visit import Fleet, State, Visit, visited

FURTHEST_NS = 100_000_000
"""Ten times what chrony leaves on a radio link, and less than what a running process corrects for itself."""
VERSIONS = ("program", "build", "messages")
"""A build is the digest of the program's wheel: two checkouts of one version may differ."""


def standing_findings(laboratory: Laboratory) -> list[Finding]:
    """About every machine; one that is not like the others, or not what [versions] says, is bad."""
    return asyncio.run(_standing(laboratory))


async def _standing(laboratory: Laboratory) -> list[Finding]:
    async with visited(laboratory, lambda machine, step: None) as fleet:  # noqa: ARG005
        found = list(_findings(laboratory, fleet))
        await fleet.each(partial(_look_at_clock, found))
        lost = [outcome for outcome in fleet.outcomes if outcome.reason and outcome.state is State.FAILED]
        return found + [bad(outcome.name, outcome.reason, "see docs/boards.md") for outcome in lost]


def _findings(laboratory: Laboratory, fleet: Fleet) -> Iterator[Finding]:
    wanted = {name: _wanted(laboratory, fleet, name) for name in VERSIONS}
    for visit in fleet.visits:
        yield _versions(visit, wanted)


def _wanted(laboratory: Laboratory, fleet: Fleet, name: str) -> str:
    """What the file says, or else what most machines run."""
    running = Counter(str(visit.found["about"].get(name, "")) for visit in fleet.visits)
    said = str(getattr(laboratory.versions, name, ""))
    return said or (running.most_common(1)[0][0] if running else "")


def _versions(visit: Visit, wanted: Mapping[str, str]) -> Finding:
    about: Mapping[str, Any] = visit.found["about"]
    deploy = "bring all machines to one version with `swarm deploy`"
    if not visit.found["current"]:
        return bad(visit.outcome.name, "runs nothing yet", deploy)
    running = ", ".join(f"{name} {about[name]}" for name in VERSIONS)
    told = f"release {visit.found['current']}: {running}"
    differing = [f"{name} {wanted[name]}" for name in VERSIONS if about[name] != wanted[name]]
    if differing:
        return bad(visit.outcome.name, f"{told}; the others have {', '.join(differing)}", deploy)
    return good(visit.outcome.name, told)


async def _look_at_clock(found: list[Finding], visit: Visit) -> None:
    ahead_ns, error_ns = await visit.link.clock_ahead_ns()
    about, ahead_ms = f"clock of {visit.outcome.name}", ahead_ns / 1e6
    told = f"{abs(ahead_ms):.1f} ms {'ahead' if ahead_ns > 0 else 'behind'}, to {error_ns / 1e6:.1f} ms"
    if abs(ahead_ns) > FURTHEST_NS + error_ns:
        found.append(bad(about, told, "set it by the server's: deploy/chrony"))
    else:
        found.append(good(about, told))
