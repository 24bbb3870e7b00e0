"""Whether this machine can run a simulation: room, places to write to, packages, the socket."""

from __future__ import annotations

import importlib.util
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from swarm.checkup.finding import Finding, bad, good, warning
from swarm.config.experiment import Experiment

LAB_MODULES = (
    "foxglove_schemas_protobuf",
    "matplotlib",
    "mcap",
    "numba",
    "polars",
    "rich",
    "scipy",
    "small_mcap",
    "typer",
)
"""Of the extra `lab` in pyproject.toml, as Python imports them."""
RESERVE_BYTES = 64 << 20
"""A run that finds less does not start, and one that is left with less pauses: its log's index, its manifest
and the processes' output still have room, and so have others on the machine."""
BYTES_A_MOVE = 6_000
"""Of a log, for each robot: that of `make demo` takes 5.6 kB."""
LONGEST_SOCKET_PATH = 107
"""Bytes of sun_path in Linux's unix(7), without the closing zero."""
SOCKET_IN_TEMPORARY = "/swarm-12345678/hub"
"""What the server adds to the directory for temporary files."""


def machine_findings(experiment: Experiment, out: Path | None) -> Iterator[Finding]:
    """About this machine, for a simulation whose run goes to `out` (None: below runs/)."""
    yield packages()
    yield temporary_place()
    yield from room(experiment, out or Path("runs") / experiment.run.name)


def packages() -> Finding:
    """The extra that a laboratory's machine needs."""
    missing = [module for module in LAB_MODULES if importlib.util.find_spec(module) is None]
    if missing:
        return bad("packages", f"{', '.join(missing)} is missing", "pip install 'swarm-runtime[lab]'")
    return good("packages", "the extra lab is installed")


def temporary_place() -> Finding:
    """The processes of a simulation meet at a socket there, whose path must be short."""
    about, cure = "temporary files", "set TMPDIR to a short path that you may write to, such as /tmp"
    try:
        place = tempfile.gettempdir()
    except OSError as error:
        return bad(about, f"there is no place for them ({error.strerror})", cure)
    length = len(os.fsencode(place + SOCKET_IN_TEMPORARY))
    if length > LONGEST_SOCKET_PATH:
        longest = LONGEST_SOCKET_PATH - len(SOCKET_IN_TEMPORARY)
        return bad(about, f"{place} is longer than {longest} bytes: no socket can be made there", cure)
    return good(about, place)


def room(experiment: Experiment, out: Path) -> Iterator[Finding]:
    """Whether the run's directory can be made, and the log has room."""
    parent = _existing(out.parent)
    about, cure = "run directory", "choose another --out"
    if os.path.lexists(out):
        yield bad(about, f"{out}: exists already; nothing is overwritten", cure)
    elif not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        yield bad(about, f"{parent}: nothing can be made there", cure)
    else:
        yield good(about, f"{parent} can be written to")
        yield _enough(experiment, parent)


def writable(about: str, directory: Path) -> Finding:
    """Whether files can be made in a directory that may not be there yet; nothing is written."""
    parent = _existing(directory)
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        return bad(
            about, f"{directory} cannot be written to", "choose a directory that this user may write to"
        )
    if free_bytes(parent) < RESERVE_BYTES:
        return bad(about, f"the disk of {directory} is full", "free some space, or choose another")
    return good(about, f"{directory} can be written to")


def lack_of_room(place: Path, free: Callable[[Path], int], more_bytes: int = 0) -> str:
    """Why nothing more may be recorded: less than the reserve, and so much more, is free. Empty if it may."""
    if free(place) >= RESERVE_BYTES + more_bytes:
        return ""
    return f"the disk of {place} is full but for {_megabytes(RESERVE_BYTES)}: free some space"


def free_bytes(place: Path) -> int:
    """What an ordinary user may still write there."""
    return shutil.disk_usage(place).free


def _enough(experiment: Experiment, place: Path) -> Finding:
    run, free = experiment.run, free_bytes(place)
    needed = run.trials * run.moves * len(experiment.robot) * BYTES_A_MOVE
    cure = "free some space, or choose another --out"
    if free < RESERVE_BYTES:
        return bad("disk", f"{place}: {_megabytes(free)} free, {_megabytes(RESERVE_BYTES)} are kept", cure)
    if free < needed + RESERVE_BYTES:
        return warning("disk", f"{_megabytes(free)} free, the logs may need {_megabytes(needed)}", cure)
    return good("disk", f"{_megabytes(free)} free, the logs may need {_megabytes(needed)}")


def _megabytes(size: int) -> str:
    return f"{size / 1e6:,.0f} MB"


def _existing(directory: Path) -> Path:
    """The directory, or the nearest above it that is there."""
    while not os.path.lexists(directory) and directory != directory.parent:
        directory = directory.parent
    return directory
