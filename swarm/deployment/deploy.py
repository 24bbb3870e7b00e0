"""What `swarm deploy` does: every machine at once, each on its own, so that one that fails stops no other."""

from __future__ import annotations

import asyncio

from swarm.config.laboratory import Laboratory
from swarm.deployment.fleet import SERVER
from swarm.deployment.link import MachineError
from swarm.deployment.plan import Plan, Planner
from swarm.deployment.visit import Fleet, Outcome, State, Tell, Visit, visited
from swarm.errors import UserError


def deploy(
    laboratory: Laboratory,
    planner: Planner,
    tell: Tell,
    *,
    dry_run: bool = False,
    interrupt: bool = False,
) -> list[Outcome]:
    """Bring every machine to what the laboratory file says; with `dry_run` only find out what that changes.

    UserError, before anything is touched, if a run is under way that `interrupt` does not allow to be ended.
    """
    return asyncio.run(Deployment(laboratory, planner, tell).run(dry_run, interrupt))


def roll_back(laboratory: Laboratory, tell: Tell, *, interrupt: bool = False) -> list[Outcome]:
    """Bring every machine back to the release that it ran before; UserError as above."""
    return asyncio.run(_rolled_back(laboratory, tell, interrupt))


class Deployment:
    """One call of `swarm deploy`."""

    def __init__(self, laboratory: Laboratory, planner: Planner, tell: Tell) -> None:
        self._laboratory = laboratory
        self._planner = planner
        self._tell = tell
        self._plans: dict[str, Plan] = {}

    async def run(self, dry_run: bool, interrupt: bool) -> list[Outcome]:
        """Look at all machines, plan for all, and then change them."""
        async with visited(self._laboratory, self._tell) as fleet:
            await fleet.each(self._plan)
            if not dry_run:
                if any(visit.outcome.state is State.WOULD_CHANGE for visit in fleet.visits):
                    _refuse_to_end_a_run(fleet, interrupt)
                await fleet.each(self._change)
            return fleet.outcomes

    async def _plan(self, visit: Visit) -> None:
        plan = await self._planner.plan(visit.target, visit.found)
        outcome = visit.outcome
        self._plans[outcome.name] = plan
        outcome.release, outcome.changes = plan.release, plan.changes
        outcome.copied = [file.name for file in plan.missing.values()]
        outcome.services = visit.found["services"]
        is_same = visit.found["current"] == plan.release
        runs = all(outcome.services.get(name) == "active" for name in plan.services)
        outcome.state = State.UNCHANGED if is_same and runs else State.WOULD_CHANGE

    async def _change(self, visit: Visit) -> None:
        if visit.outcome.state is not State.WOULD_CHANGE:
            return
        visit.outcome.state = State.FAILED
        plan, policies = self._plans[visit.outcome.name], self._laboratory.policies
        for place, file in plan.missing.items():
            self._tell(visit.outcome.name, f"copying {file.name} ({file.stat().st_size / 1e6:.1f} MB)")
            await visit.link.copy(file, f"wheels/{place}")
        versions = await visit.link.ask("install", **plan.request)
        self._check_versions(versions)
        within = {"within_s": policies.healthy_within_s, "keep": policies.keep_releases}
        done = await visit.link.ask("activate", release=plan.release, **within)
        visit.outcome.services = done["services"]
        visit.outcome.state = State.DEPLOYED

    def _check_versions(self, installed: dict[str, str]) -> None:
        """MachineError if what was installed is not what the laboratory file says."""
        wanted = vars(self._laboratory.versions)
        for name, version in wanted.items():
            if version and installed[name] != version:
                raise MachineError(f"{name} is {installed[name]} and [versions] says {version}")


def _refuse_to_end_a_run(fleet: Fleet, interrupt: bool) -> None:
    for visit in fleet.visits:
        if visit.found["services"].get(f"{SERVER}.service") == "active" and not interrupt:
            raise UserError(
                f"a run is under way ({visit.outcome.name}): wait for its end, or end it with --interrupt"
            )


async def _rolled_back(laboratory: Laboratory, tell: Tell, interrupt: bool) -> list[Outcome]:
    async def go_back(visit: Visit) -> None:
        done = await visit.link.ask("go_back", within_s=laboratory.policies.healthy_within_s)
        visit.outcome.release, visit.outcome.services = done["release"], done["services"]
        visit.outcome.state = State.ROLLED_BACK

    async with visited(laboratory, tell) as fleet:
        _refuse_to_end_a_run(fleet, interrupt)
        await fleet.each(go_back)
        return fleet.outcomes
