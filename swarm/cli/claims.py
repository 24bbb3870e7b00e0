"""`swarm claims`: what the paper says of its simulations, beside what was measured."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from swarm.cli.output import print_json
from swarm.cli.reproduce import Jobs, Json, Out, Runs, Seed, Steps, told_when_interrupted
from swarm.cli.values import Scheduler
from swarm.config.limits import MOST_TRIALS
from swarm.extras import require_extra
from swarm.parallel import available_cores

if TYPE_CHECKING:
    from swarm.paper.options import Settings

Figures = Annotated[
    list[str] | None, typer.Argument(help="fig12, 12, all, or a study file.", show_default="all")
]


ReadingsOption = Annotated[
    bool, typer.Option("--readings", help="Judge also under every alternative of the paper's open points.")
]
ReadingsRuns = Annotated[
    int, typer.Option(min=1, max=MOST_TRIALS, help="Runs of each condition under each of these readings.")
]
ReadingOption = Annotated[
    list[str] | None,
    typer.Option(help="A reading other than the default, such as first-copy=before-the-first-run."),
]


def judge_claims(
    words: Sequence[str],
    command: str,
    *,
    grid_runs: int | None = None,
    reading: Sequence[str] = (),
    **asked: Any,
) -> tuple[dict[str, Any], list[str]]:
    """The claims about the figures that `words` name, judged and reported.

    Returns the result as plain data, and the same as lines to read; `asked` are the fields of `Settings`.
    With `grid_runs`, also under every other reading, with so many runs of each condition.
    """
    require_extra("lab", "numba", "scipy", "polars", "matplotlib")
    from swarm.paper.assessment import assess
    from swarm.paper.catalogue import chosen_names
    from swarm.paper.options import Settings
    from swarm.paper.readings import parse_readings
    from swarm.paper.report import summary, write_report
    from swarm.paper.report_json import as_json

    names = chosen_names(words or ["all"])
    settings = Settings(**asked, readings=parse_readings(list(reading)))
    page, under, counts = _under_readings(names, settings, grid_runs) if grid_runs else ("", {}, [])
    assessment = assess(names, settings)
    files = {form: str(path) for form, path in write_report(assessment, command, page).items()}
    lines = [f"{one.figure}: {one.verdict.value}: {one.claim.text}" for one in assessment.judged]
    result = {**as_json(assessment), **under, "files": files}
    return result, [*lines, summary(assessment), *counts, *files.values()]


def _under_readings(names: list[str], settings: Settings, runs: int) -> tuple[str, dict[str, Any], list[str]]:
    """The page, the plain data and the lines of the grid of readings."""
    from swarm.paper import grid

    found = grid.assess_readings(names, settings, runs)
    data = grid.as_json(found)
    lines = [f"{label}: {verdicts['hold']} hold of {found.runs} runs" for label, verdicts in data.items()]
    return grid.as_markdown(found), {"readings": data}, lines


def claims_command(
    figure: Figures = None,
    runs: Runs = None,
    steps: Steps = None,
    seed: Seed = 1,
    out: Out = None,
    jobs: Jobs = None,
    scheduler: Scheduler = "processes",
    readings: ReadingsOption = False,
    readings_runs: ReadingsRuns = 25,
    reading: ReadingOption = None,
    json: Json = False,
) -> None:
    """Judge every claim of the text about the simulated figures, by the paper's test and a family-wise."""
    asked: dict[str, Any] = {"runs": runs, "steps": steps, "seed": seed, "out": out, "scheduler": scheduler}
    choice: dict[str, Any] = {"grid_runs": readings_runs if readings else None, "reading": reading or []}
    command = shlex.join(["swarm", *sys.argv[1:]])
    with told_when_interrupted():
        count = len(available_cores()) if jobs is None else jobs
        result, lines = judge_claims(figure or [], command, **choice, **asked, jobs=count)
    if json:
        print_json(result)
    else:
        typer.echo("\n".join(lines))
