"""`swarm trials`: many trials of an experiment by the abstract engine."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from swarm.cli import section_3
from swarm.cli.output import print_json
from swarm.cli.values import Changes, Scheduler, good_place
from swarm.config.limits import LARGEST_SEED, MOST_JOBS, MOST_MOVES, MOST_TRIALS
from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.files import new_folder
from swarm.parallel import available_cores, check_scheduler

if TYPE_CHECKING:
    from swarm.config.experiment import Experiment
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
    scheduler: str,
    changes: list[str],
) -> dict[str, Any]:
    """Run the trials, and write picture and tables into a new directory."""
    require_extra("lab", "scipy", "polars", "matplotlib")
    from swarm.surrogate.copies import STORED_COPIES
    from swarm.surrogate.durations import MEASURED_DURATIONS
    from swarm.surrogate.plots import first_trials, write_picture
    from swarm.surrogate.trials import PAPER_TRIALS, run_trials, summary, write_tables

    check_scheduler(scheduler)
    experiment = _good_experiment(file, seed, moves, changes)
    of_full = _curves_of(full) if full else None
    directory = new_folder(out)
    stored = copies or STORED_COPIES, durations or MEASURED_DURATIONS
    many = run_trials(experiment, *stored, trials, jobs, scheduler=scheduler)
    files = write_tables(many, directory) | {"picture": str(directory / "curves.png")}
    note = NOTE.format(cap=experiment.learning.path_length_cap) + (FULL_NOTE if of_full else "")
    few = of_full or first_trials(many.curves, PAPER_TRIALS)
    write_picture(few, many.curves, experiment.run.name, note, directory / "curves.png")
    made = {"experiment": experiment.run.name, "set": changes, "trials": trials}
    return {**made, "conditions": summary(many), "files": files}


def _curves_of(runs: list[Path]) -> dict[str, Curves]:
    """The learning curves in the logs of a full simulation."""
    from swarm.analysis.inputs import find_inputs
    from swarm.analysis.learning_curves import read_curves

    require_extra("lab", "mcap")
    with tempfile.TemporaryDirectory() as folder:
        return read_curves(find_inputs(runs).logs, Path(folder)).curves


ExperimentFile = Annotated[Path, typer.Argument(help="An experiment file, such as deploy/sim/expert.toml.")]
Trials = Annotated[int, typer.Option(min=1, max=MOST_TRIALS, help="Trials of each condition.")]
Moves = Annotated[
    int | None,
    typer.Option(min=1, max=MOST_MOVES, help="Moves of each learner.", show_default="the file's"),
]
Seed = Annotated[
    int | None,
    typer.Option(min=0, max=LARGEST_SEED, help="The root of all randomness.", show_default="the file's"),
]
Copies = Annotated[
    Path | None,
    typer.Option(help="Stored copies, made by `robot-agent collect-copies`.", show_default="the package's"),
]
Durations = Annotated[
    Path | None,
    typer.Option(help="Durations of moves, made by `swarm durations`.", show_default="the package's"),
]
Full = Annotated[
    list[Path] | None,
    typer.Option(
        help="A run of the full simulation, for the picture on the left.",
        show_default="the first 4 trials",
    ),
]
Claims = Annotated[
    Path | None,
    typer.Option(help="Judge the paper's section 3, with this experiment of two learners beside."),
]
Study = Annotated[
    Path | None,
    typer.Option(help="Ask whether copying errors help (section 3.5), with this experiment of two learners."),
]
Out = Annotated[
    Path | None,
    typer.Option(
        help="Where results go: a new directory.", show_default="runs/trials/NAME", callback=good_place
    ),
]
Jobs = Annotated[
    int | None, typer.Option(min=1, max=MOST_JOBS, help="Trials at a time.", show_default="all cores")
]


def trials_command(
    experiment: ExperimentFile,
    trials: Trials = 100,
    moves: Moves = None,
    seed: Seed = None,
    copies: Copies = None,
    durations: Durations = None,
    full: Full = None,
    claims: Claims = None,
    study: Study = None,
    out: Out = None,
    jobs: Jobs = None,
    scheduler: Scheduler = "processes",
    changes: Changes = None,
    json: Json = False,
) -> None:
    """Run many trials without wheels: the learning of the robots on measured durations and stored copies."""
    out = out or Path("runs") / "trials" / experiment.stem
    count = jobs or len(available_cores())
    if claims or study:
        asked = trials, moves, seed, changes or []
        result = _section_3(experiment, claims, study, asked, (copies, durations), out, count)
        told = section_3.lines(result)
    else:
        files = (copies, durations, full or [], out)
        result = many_trials(experiment, trials, moves, seed, *files, count, scheduler, changes or [])
        told = _lines(result)
    if json:
        print_json(result)
    else:
        typer.echo("\n".join(told))


def _section_3(
    expert: Path,
    claims: Path | None,
    study: Path | None,
    settings: tuple[int, int | None, int | None, list[str]],
    stored: tuple[Path | None, Path | None],
    out: Path,
    jobs: int,
) -> dict[str, Any]:
    require_extra("lab", "scipy", "polars")
    from swarm.surrogate.copies import STORED_COPIES
    from swarm.surrogate.durations import MEASURED_DURATIONS

    if claims and study:
        raise UserError("--claims and --study: give one of them at a time")
    trials, moves, seed, changes = settings
    both = [_good_experiment(file, seed, moves, changes) for file in (expert, claims or study) if file]
    run = section_3.judged_claims if claims else section_3.studied_errors
    copies, durations = stored[0] or STORED_COPIES, stored[1] or MEASURED_DURATIONS
    asked = section_3.AskedTrials((both[0], both[1]), copies, durations, trials, jobs)
    return run(asked, new_folder(out))


def _good_experiment(file: Path, seed: int | None, moves: int | None, changes: list[str]) -> Experiment:
    from swarm.checkup.checkup import experiment_findings
    from swarm.checkup.finding import require_good
    from swarm.config.experiment import Experiment

    experiment = Experiment.load(file, changes).changed(seed=seed, moves=moves)
    require_good(file, experiment_findings(experiment))
    return experiment


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
