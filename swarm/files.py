"""Files that are new, or replaced whole: nothing is overwritten and nothing is left half-written."""

from __future__ import annotations

import os
from collections.abc import Callable
from io import BufferedWriter
from pathlib import Path
from typing import TYPE_CHECKING

from swarm.errors import RunFailedError, UserError

if TYPE_CHECKING:
    pass


def new_file(path: Path) -> BufferedWriter:
    """Open a file for writing; UserError if it is there already or cannot be made."""
    try:
        return path.open("xb")
    except FileExistsError as error:
        raise UserError(f"{path}: exists already; nothing is overwritten, choose another --out") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --out") from error


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Call `write` with a temporary name and give the file its own name once it is on the disk."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise RunFailedError(f"{path} cannot be written ({error}); what was finished is kept") from error
    finally:
        temporary.unlink(missing_ok=True)
