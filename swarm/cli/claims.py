"""`swarm claims`: what the paper says of its simulations, beside what was measured."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from swarm.cli.output import print_json
from swarm.cli.reproduce import Jobs, Json, Out, Runs, Seed, Steps, told_when_interrupted
from swarm.cli.values import Scheduler
from swarm.extras import require_extra
from swarm.parallel import available_cores

Figures = Annotated[
    list[str] | None, typer.Argument(help="fig12, 12, all, or a study file.", show_default="all")
]


def judge_claims(words: Sequence[str], command: str, **asked: Any) -> tuple[dict[str, Any], list[str]]:
    """The claims about the figures that `words` name, judged and reported.

    Returns the result as plain data, and the same as lines to read; `asked` are the fields of `Settings`.
    """
    require_extra("lab", "numba", "scipy", "polars", "matplotlib")
    from swarm.paper.assessment import assess
    from swarm.paper.catalogue import chosen_names
    from swarm.paper.options import Settings
    from swarm.paper.report import summary, write_report
    from swarm.paper.report_json import as_json

    assessment = assess(chosen_names(words or ["all"]), Settings(**asked))
    files = {form: str(path) for form, path in write_report(assessment, command).items()}
    lines = [f"{one.figure}: {one.verdict.value}: {one.claim.text}" for one in assessment.judged]
    return {**as_json(assessment), "files": files}, [*lines, summary(assessment), *files.values()]


def claims_command(
    figure: Figures = None,
    runs: Runs = None,
    steps: Steps = None,
    seed: Seed = 1,
    out: Out = None,
    jobs: Jobs = None,
    scheduler: Scheduler = "processes",
    json: Json = False,
) -> None:
    """Judge every claim of the text about the simulated figures, by the paper's test and a family-wise."""
    asked = {"runs": runs, "steps": steps, "seed": seed, "out": out, "scheduler": scheduler}
    command = shlex.join(["swarm", *sys.argv[1:]])
    with told_when_interrupted():
        count = len(available_cores()) if jobs is None else jobs
        result, lines = judge_claims(figure or [], command, **asked, jobs=count)
    if json:
        print_json(result)
    else:
        typer.echo("\n".join(lines))
