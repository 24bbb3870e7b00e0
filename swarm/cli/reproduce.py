"""`swarm reproduce`: the simulated figures of the paper, and any study written like them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from swarm.cli.output import print_json
from swarm.cli.values import Scheduler, good_place
from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.parallel import available_cores

Runs = Annotated[
    int | None, typer.Option(help="Runs of each condition.", show_default="100, as in the paper")
]
Steps = Annotated[
    int | None, typer.Option(help="Time steps of each run.", show_default="as many as the paper's figure")
]
Seed = Annotated[int, typer.Option(help="The root of all randomness.")]
Out = Annotated[
    Path | None,
    typer.Option(
        help="Where results go; a directory of the same settings is resumed.",
        show_default="runs/reproduce/seed-SEED",
        callback=good_place,
    ),
]
Jobs = Annotated[int | None, typer.Option(help="Runs at a time.", show_default="the number of cores")]
Json = Annotated[bool, typer.Option("--json", help="Print the results as one JSON object.")]


def reproduce_figures(words: Sequence[str], **asked: Any) -> dict[str, Any]:
    """The figures that `words` name, reproduced; `asked` are the fields of `Settings`."""
    require_extra("lab", "numba", "scipy", "polars", "matplotlib")
    from swarm.paper.catalogue import chosen_names, load_figure
    from swarm.paper.options import Settings
    from swarm.paper.runner import reproduce

    settings = Settings(**asked)
    if not words:
        raise UserError("name the figures to reproduce, such as fig3, or all")
    return reproduce([load_figure(name) for name in chosen_names(words)], settings)


def reproduce_command(
    figure: Annotated[
        list[str], typer.Argument(help="fig3, 3, figure3, all, or a study file such as my_study.py.")
    ],
    runs: Runs = None,
    steps: Steps = None,
    seed: Seed = 1,
    out: Out = None,
    jobs: Jobs = None,
    scheduler: Scheduler = "processes",
    json: Json = False,
) -> None:
    """Reproduce the paper's simulated figures: a plot and a table each, from runs in parallel."""
    asked = {"runs": runs, "steps": steps, "seed": seed, "out": out, "scheduler": scheduler}
    with told_when_interrupted():
        results = reproduce_figures(figure, **asked, jobs=len(available_cores()) if jobs is None else jobs)
    if json:
        print_json(results)
        return
    for name, result in results.items():
        typer.echo(f"{name}: {', '.join(result['files'].values())}")


@contextmanager
def told_when_interrupted() -> Iterator[None]:
    """Ctrl-C loses no finished run; say so."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(
            "interrupted: what was finished is kept, and the same command goes on from there", err=True
        )
        raise
