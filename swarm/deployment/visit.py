"""A machine while it is worked on: the way there, what it says of itself, and what comes of it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from functools import partial
from typing import Any

from swarm.config.laboratory import Laboratory
from swarm.deployment.fleet import Target, targets
from swarm.deployment.link import Link, MachineError, in_words, linked
from swarm.deployment.wheels import SYSTEM_PACKAGES
from swarm.errors import UserError

Tell = Callable[[str, str], None]
"""Called with a machine's name and with what happens there."""


class State(StrEnum):
    """What became of a machine."""

    DEPLOYED = "deployed"
    UNCHANGED = "unchanged"
    """It runs all of it already: nothing was touched."""
    WOULD_CHANGE = "would change"
    ROLLED_BACK = "rolled back"
    """As asked, to the release before."""
    FAILED = "failed"
    """The reason says why, and what runs now."""


@dataclass
class Outcome:
    """A line of the result."""

    name: str
    host: str
    state: State = State.FAILED
    release: str = ""
    """What was deployed, or would be."""
    changes: list[str] = field(default_factory=list)
    copied: list[str] = field(default_factory=list)
    """Wheels that were not there yet."""
    services: dict[str, str] = field(default_factory=dict)
    reason: str = ""

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints of it."""
        return {**asdict(self), "state": self.state.value}


@dataclass
class Visit:
    """One machine."""

    target: Target
    link: Link
    found: dict[str, Any]
    """What the machine says of itself (swarm.deployment.board.machine)."""
    outcome: Outcome


Work = Callable[[Visit], Awaitable[None]]


@dataclass
class Fleet:
    """The machines of a laboratory that could be reached, and what becomes of all of them."""

    outcomes: list[Outcome]
    visits: list[Visit]

    async def each(self, work: Work) -> None:
        """Do something with every machine at once; one that fails stops no other."""
        await asyncio.gather(*(_guarded(visit.outcome, work(visit)) for visit in self.visits))


@asynccontextmanager
async def visited(laboratory: Laboratory, tell: Tell) -> AsyncIterator[Fleet]:
    """All machines of a laboratory, connected and looked at. UserError if two of them are one."""
    found = targets(laboratory)
    outcomes = [Outcome(target.name, target.machine.host) for target in found]
    visits: list[Visit] = []
    async with AsyncExitStack() as stack:
        reached = (
            _guarded(outcome, _reached(laboratory, target, outcome, stack, tell, visits))
            for target, outcome in zip(found, outcomes, strict=True)
        )
        await asyncio.gather(*reached)
        visits.sort(key=lambda visit: outcomes.index(visit.outcome))
        _check_copies(visits)
        yield Fleet(outcomes, visits)


async def _reached(
    laboratory: Laboratory,
    target: Target,
    outcome: Outcome,
    stack: AsyncExitStack,
    tell: Tell,
    visits: list[Visit],
) -> None:
    policies, say = laboratory.policies, partial(tell, outcome.name)
    link = await stack.enter_async_context(
        linked(target.machine, policies.services.value, policies.known_hosts, say)
    )
    await link.prepare()
    found = await link.ask("look", packages=SYSTEM_PACKAGES)
    visits.append(Visit(target, link, found, outcome))


async def _guarded(outcome: Outcome, work: Awaitable[None]) -> None:
    try:
        with in_words():
            await work
    except (MachineError, UserError) as error:
        outcome.state = State.FAILED
        outcome.reason = str(error)


def _check_copies(visits: Iterable[Visit]) -> None:
    """Whoever copies a card copies its host key: two machines with one key cannot be told apart."""
    first: dict[str, Visit] = {}
    for visit in visits:
        other = first.setdefault(visit.link.host_key, visit)
        if other.target.machine.host != visit.target.machine.host:
            raise UserError(
                f"{other.outcome.name} and {visit.outcome.name} have the same host key: one card is a copy "
                "of the other, or both names lead to one machine; make new keys with ssh-keygen -A on one"
            )
