"""`swarm durations`: how long moves take in a log, for `swarm trials`."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.extras import require_extra

Json = Annotated[bool, typer.Option("--json", help="Print the results as one JSON object.")]


def durations_command(
    run: Annotated[list[Path], typer.Argument(help="Run directories or .mcap files.")],
    out: Annotated[Path, typer.Option(help="A new CSV file.", callback=good_place)] = Path("durations.csv"),
    json: Json = False,
) -> None:
    """Measure in logs how long moves and drives back take, for `swarm trials --durations`."""
    require_extra("lab", "mcap", "polars")
    from swarm.surrogate.durations import write_durations

    seconds = measured_in(run)
    told = "seconds of driven moves by turn (eighths of a circle) and way, measured in a simulated run"
    write_durations(seconds, out, told)
    counts = {kind: len(found) for kind, found in seconds.items()}
    if json:
        print_json({"file": str(out), "measured": counts})
    else:
        typer.echo(f"wrote {out}: {sum(counts.values())} durations of {len(counts)} kinds")


def measured_in(runs: list[Path]) -> dict[str, list[float]]:
    """Seconds by kind in the logs of these runs."""
    import polars as pl

    from swarm.analysis.inputs import find_inputs
    from swarm.geometry import Move
    from swarm.logs.parquet import read_logs
    from swarm.surrogate.durations import Step, measured

    logs = find_inputs(runs).logs
    goals = {log.trial_log: log.grid.goal for log in logs}
    with tempfile.TemporaryDirectory() as folder:
        tables = read_logs(logs, Path(folder), False, lambda _: None).tables
        moves = pl.read_parquet(tables["moves"], glob=False).sort("log", "publish_t_ns", maintain_order=True)
        carries = pl.read_parquet(tables["carries"], glob=False)
    carried_s: dict[str, list[float]] = defaultdict(list)
    for row in carries.iter_rows(named=True):
        carried_s[f"{row['log']}/{row['robot']}"].append(row["publish_t_ns"] * 1e-9)
    steps = (
        Step(
            f"{row['log']}/{row['robot']}",
            Move[row["action"]],
            row["blocked"],
            row["next_state"] == goals[row["log"]],
            row["duration_s"],
            row["publish_t_ns"] * 1e-9,
        )
        for row in moves.iter_rows(named=True)
    )
    return measured(steps, carried_s)
