"""`swarm trials`: many trials of an experiment by the abstract engine."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.config.limits import LARGEST_SEED, MOST_JOBS, MOST_MOVES, MOST_TRIALS
from swarm.extras import require_extra
from swarm.files import new_folder
from swarm.parallel import available_cores

if TYPE_CHECKING:
    from swarm.statistics.samples import Curves

NOTE = (
    "Algorithm 3 on measured durations, copies drawn from rendered ones; "
    "a path that does not arrive counts as {cap}."
)
FULL_NOTE = " Left: the full simulation, with rendered cameras."

Json = Annotated[bool, typer.Option("--json", help="Print the results as one JSON object.")]


def many_trials(
    file: Path,
    trials: int,
    moves: int | None,
    seed: int | None,
    copies: Path | None,
    durations: Path | None,
    full: list[Path],
    out: Path,
    jobs: int,
) -> dict[str, Any]:
    """Run the trials, and write picture and tables into a new directory."""
    require_extra("lab", "scipy", "polars", "matplotlib")
    from swarm.checkup.checkup import experiment_findings
    from swarm.checkup.finding import require_good
    from swarm.config.experiment import Experiment
    from swarm.surrogate.copies import STORED_COPIES
    from swarm.surrogate.durations import MEASURED_DURATIONS
    from swarm.surrogate.plots import first_trials, write_picture
    from swarm.surrogate.trials import PAPER_TRIALS, run_trials, summary, write_tables

    experiment = Experiment.load(file).changed(seed=seed, moves=moves)
    require_good(file, experiment_findings(experiment))
    of_full = _curves_of(full) if full else None
    directory = new_folder(out)
    many = run_trials(experiment, copies or STORED_COPIES, durations or MEASURED_DURATIONS, trials, jobs)
    files = write_tables(many, directory) | {"picture": str(directory / "curves.png")}
    note = NOTE.format(cap=experiment.learning.path_length_cap) + (FULL_NOTE if of_full else "")
    few = of_full or first_trials(many.curves, PAPER_TRIALS)
    write_picture(few, many.curves, experiment.run.name, note, directory / "curves.png")
    return {"experiment": experiment.run.name, "trials": trials, "conditions": summary(many), "files": files}


def _curves_of(runs: list[Path]) -> dict[str, Curves]:
    """The learning curves in the logs of a full simulation."""
    import polars as pl

    from swarm.analysis.inputs import find_inputs
    from swarm.analysis.learning_curves import run_curves
    from swarm.logs.parquet import read_logs

    require_extra("lab", "mcap")
    with tempfile.TemporaryDirectory() as folder:
        logs = find_inputs(runs).logs
        tables = read_logs(logs, Path(folder), False, lambda _: None).tables
        shortest_moves = min(log.shortest_moves for log in logs)
        return run_curves(pl.read_parquet(tables["best_paths"], glob=False), shortest_moves).curves


def trials_command(
    experiment: Annotated[Path, typer.Argument(help="An experiment file, such as deploy/sim/expert.toml.")],
    trials: Annotated[int, typer.Option(min=1, max=MOST_TRIALS, help="Trials of each condition.")] = 100,
    moves: Annotated[
        int | None,
        typer.Option(min=1, max=MOST_MOVES, help="Moves of each learner.", show_default="the file's"),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=LARGEST_SEED, help="The root of all randomness.", show_default="the file's"),
    ] = None,
    copies: Annotated[
        Path | None,
        typer.Option(
            help="Stored copies, made by `robot-agent collect-copies`.", show_default="the package's"
        ),
    ] = None,
    durations: Annotated[
        Path | None,
        typer.Option(help="Durations of moves, made by `swarm durations`.", show_default="the package's"),
    ] = None,
    full: Annotated[
        list[Path] | None,
        typer.Option(
            help="A run of the full simulation, for the picture on the left.",
            show_default="the first 4 trials",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Where results go: a new directory.", show_default="runs/trials/NAME", callback=good_place
        ),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=MOST_JOBS, help="Trials at a time.", show_default="all cores")
    ] = None,
    json: Json = False,
) -> None:
    """Run many trials without wheels: the learning of the robots on measured durations and stored copies."""
    out = out or Path("runs") / "trials" / experiment.stem
    count = jobs or len(available_cores())
    result = many_trials(experiment, trials, moves, seed, copies, durations, full or [], out, count)
    if json:
        print_json(result)
    else:
        typer.echo("\n".join(_lines(result)))


def _lines(result: dict[str, Any]) -> list[str]:
    lines = []
    for name, found in result["conditions"].items():
        if "stays_low_from" in found:
            at = ", ".join(_at(move, *numbers) for move, numbers in found["mean_and_interval"].items())
            low_from = found["stays_low_from"]
            end = "never 12 or less to the end" if low_from is None else f"12 or less from {low_from:.0f} on"
            lines.append(f"{name} ({found['trials']} trials): {at}; {end}")
    copies = result["conditions"]["copies"]
    lines.append(f"paths remembered: {copies['remembered']}, of which wrong: {copies['wrong']}")
    return [*lines, *(f"wrote {path}" for path in result["files"].values())]


def _at(move: str, mean: float, low: float | None, high: float | None) -> str:
    return f"{move}: {mean}" if low is None else f"{move}: {mean} ({low} to {high})"
