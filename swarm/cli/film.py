"""`swarm film`: a stretch of one robot's learning as a film."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.config.limits import MOST_MOVES
from swarm.extras import require_extra
from swarm.files import printable

LONGEST_S = 3600
"""An hour; somebody who wants more meant moves."""


def moves_of(text: str) -> tuple[int, int]:
    """FIRST:LAST."""
    first, colon, last = text.partition(":")
    numbers = [int(word) if word.isascii() and word.isdecimal() else -1 for word in (first, last)]
    if not colon or not 0 <= numbers[0] < numbers[1] <= MOST_MOVES:
        raise typer.BadParameter(f"{text[:40]!r} is no FIRST:LAST, such as 500:900")
    return numbers[0], numbers[1]


def film_command(
    run: Annotated[Path, typer.Argument(help="A run directory, or the .mcap file of a trial.")],
    robot: Annotated[str, typer.Option(help="A learner.")],
    moves: Annotated[
        str, typer.Option(metavar="FIRST:LAST", help="Of its moves; 0 is the trial's beginning.")
    ],
    trial: Annotated[int, typer.Option(min=0, help="Of a run directory.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            help="A file that ends in .mp4 or .gif.",
            show_default="ROBOT-FIRST-LAST.mp4",
            callback=good_place,
        ),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.1, max=LONGEST_S, help="How long the film takes.")] = 30.0,
    rate: Annotated[int, typer.Option(min=1, max=60, help="Pictures a second.")] = 15,
    json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
) -> None:
    """Film a robot's learning: the arena with what it knows, its camera, its curve.

    Of a simulated robot the camera's pictures are made once more, and compared with the log by their hashes.
    """
    require_extra("lab", "mcap", "cv2", "matplotlib", "numba", "PIL")
    from swarm.film.film import FilmRequest, make_film
    from swarm.film.writers import check_form

    first, last = moves_of(moves)
    file = out or Path(f"{robot}-{first}-{last}.mp4")
    check_form(file)
    with _progress() as show:
        film = make_film(FilmRequest(run, robot, first, last, file, trial, seconds, rate), show)
    if json:
        print_json(film.as_json())
        return
    typer.echo(
        f"wrote {printable(film.file)}: {seconds:g} s, {film.speed:,.0f} times as fast as life, visits slower"
    )
    if film.camera_frames:
        typer.echo(f"camera: {film.same_hash} of {film.camera_frames} pictures have the hash in the log")


@contextmanager
def _progress() -> Iterator[Callable[[float], object]]:
    """A bar on a terminal; nothing elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("filming", total=1.0)
        yield lambda share: bar.update(task, completed=share)
