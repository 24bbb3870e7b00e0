"""A file that was not there before: nothing is overwritten."""

from __future__ import annotations

from io import BufferedWriter
from pathlib import Path

from swarm.errors import UserError


def new_file(path: Path) -> BufferedWriter:
    """Open a file for writing; UserError if it is there already or cannot be made."""
    try:
        return path.open("xb")
    except FileExistsError as error:
        raise UserError(f"{path}: exists already; nothing is overwritten, choose another --out") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --out") from error
