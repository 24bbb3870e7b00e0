"""Files that are new, or replaced whole: nothing is overwritten and nothing is left half-written."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable, Iterable, Sequence
from io import BufferedWriter, TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swarm.errors import RunFailedError, UserError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def printable(path: Path) -> str:
    """A path as text that can be printed and stored: bytes that are no UTF-8 as escapes."""
    return os.fsencode(path).decode("utf-8", "backslashreplace")


def new_file(path: Path) -> BufferedWriter:
    """Open a file for writing; UserError if it is there already or cannot be made."""
    try:
        return path.open("xb")
    except FileExistsError as error:
        raise UserError(f"{path}: exists already; nothing is overwritten, choose another --out") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --out") from error


def new_folder(path: Path) -> Path:
    """Make a folder, and those above it; UserError if it is there already or cannot be made."""
    try:
        path.mkdir(parents=True)
    except FileExistsError as error:
        raise UserError(f"{path}: exists already; nothing is overwritten, choose another --out") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be made ({error.strerror}); choose another --out") from error
    return path


def make_folder(path: Path) -> Path:
    """A folder, which may be there already; UserError if it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{path}: cannot be made ({error.strerror}); choose another --out") from error
    return path


def new_csv(path: Path, told: Iterable[str], columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """A new file of rows under `columns`, after comment lines that say how it was made."""
    with new_file(path) as file, TextIOWrapper(file, encoding="utf-8", newline="") as text:
        text.writelines(f"# {line}\n" for line in told)
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)


def write_whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Call `write` with a temporary name and give the file its own name once it is on the disk."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise RunFailedError(f"{path} cannot be written ({error.strerror or error})") from error
    finally:
        temporary.unlink(missing_ok=True)
    return path


def write_text(text: str, path: Path) -> Path:
    """A text, whole; in it names of files that are not UTF-8 are written with escapes."""
    data = text.encode("utf-8", "backslashreplace")
    return write_whole(path, lambda temporary: temporary.write_bytes(data))


def write_json(content: Any, path: Path) -> Path:
    """Plain data, whole; ValueError for a number that JSON does not know."""
    return write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", path)


PICTURE_DPI = 150
"""A figure of 8 inches is 1,200 pixels wide: sharp in a report, and small."""


def write_png(figure: Figure, path: Path) -> Path:
    """A picture, whole, and without date and version: the same results give the same bytes."""
    return write_whole(
        path,
        lambda temporary: figure.savefig(
            temporary, format="png", dpi=PICTURE_DPI, metadata={"Software": None}
        ),
    )
