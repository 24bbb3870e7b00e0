"""The types of values that options of several verbs share; an error says what is allowed."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from swarm.config import arguments
from swarm.config.changes import SET_HELP

Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="TABLE.KEY=VALUE", help=f"{SET_HELP}. May be repeated."),
]
Scheduler = Annotated[
    str,
    typer.Option(help="processes, dask (a local cluster), or a Dask scheduler's address tcp://HOST:PORT."),
]


def checked(read: Callable[[str], object]) -> Callable[[str | None], str | None]:
    """A typer callback that lets pass what argparse would read."""

    def check(text: str | None) -> str | None:
        try:
            if text is not None:
                read(text)
        except argparse.ArgumentTypeError as error:
            raise typer.BadParameter(str(error)) from error
        return text

    return check


def good_place(path: Path | None) -> Path | None:
    """A typer callback for a file or directory that is made."""
    checked(arguments.place)(None if path is None else str(path))
    return path
