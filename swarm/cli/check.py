"""`swarm check`: is a log complete and sound?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from swarm.cli.output import print_json
from swarm.errors import RunFailedError
from swarm.extras import require_extra
from swarm.files import printable

if TYPE_CHECKING:
    from swarm.logs.check import LogCheck


def check_command(
    log: Annotated[Path, typer.Argument(help="A .mcap file, or a run directory.")],
    firewall: Annotated[
        bool, typer.Option("--firewall", help="Say instead what crossed from robot to robot, in bytes.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the findings as one JSON object.")] = False,
) -> None:
    """Say whether a log is complete and sound: its index, checksums, gaps, duplicates, every message.

    Of a run directory every trial; if a server went on with a trial, with what is missing between its logs.
    Exit code 0: it is. 1: it is not, with the reasons. 2: it is no log of a run. With --firewall 0 if nothing
    crossed between robots but observation, and access that the experiment permits.
    """
    require_extra("lab", "mcap", "polars")
    if firewall:
        _audit(log, as_json=json)
        return
    from swarm.logs.check import check_log, check_run

    checks = check_run(log) if log.is_dir() else [check_log(log)]
    if json:
        print_json(_as_json(log, [found.as_json() for found in checks]))
    unsound = [_told(found.path, found.faults) for found in checks if found.faults]
    if not json:
        for found in checks:
            _tell(found)
    if unsound:
        raise RunFailedError("; ".join(unsound))


def _audit(path: Path, *, as_json: bool) -> None:
    from swarm.cli.output import print_table
    from swarm.logs.crossings import KINDS
    from swarm.logs.firewall import audit
    from swarm.logs.trial_logs import trials_of

    audits = [audit(parts) for parts in trials_of(path)]
    if as_json:
        holds = all(found.holds for found in audits)
        print_json({"log": printable(path), "holds": holds, "trials": [found.as_json() for found in audits]})
    for found in () if as_json else audits:
        rows = [(a, b, *(f"{counts[kind]:,}" for kind in KINDS)) for (a, b), counts in found.pairs().items()]
        print_table(("from", "to", *(f"{kind} bytes" for kind in KINDS)), rows)
        for remark in (*found.remarks, *(f"the hub refused: {text}" for text in found.refusals)):
            typer.echo(f"note: {remark}")
        if found.holds:
            typer.echo(f"{printable(found.path)}: {found.verdict}")
    failed = [f"{printable(found.path)}: {found.verdict}" for found in audits if not found.holds]
    if failed:
        raise RunFailedError("; ".join(failed))


def _as_json(log: Path, checks: list[dict[str, Any]]) -> dict[str, Any]:
    """Of a log what was found in it; of a run directory that of every trial."""
    if not log.is_dir():
        return checks[0]
    return {"run": printable(log), "sound": all(found["sound"] for found in checks), "trials": checks}


def _told(path: Path, faults: list[str]) -> str:
    more = f"; and {len(faults) - 3} more" if len(faults) > 3 else ""
    return f"{printable(path)} is not sound: {'; '.join(faults[:3])}{more}"


def _completeness(found: LogCheck) -> str:
    share = "100" if not found.holes else f"{min(99.999, 100 * found.share):.3f}"
    known = "" if not found.lacking or found.holes else " known"
    return f"complete: {share} % of {found.events:,}{known} learning events and orders"


def _tell(found: LogCheck) -> None:
    for remark in found.remarks:
        typer.echo(f"note: {remark}")
    typer.echo(f"{printable(found.path)}: {_completeness(found)}")
    for hole in found.holes:
        typer.echo(f"missing: {hole}")
    if found.sound:
        typer.echo(f"{printable(found.path)}: complete and sound, {found.messages:,} messages")
