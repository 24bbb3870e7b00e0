"""Opens a recording, whichever system wrote it."""

from __future__ import annotations

import csv
import gzip
import zlib
from collections.abc import Callable
from pathlib import Path

from swarm.errors import UserError
from tracker_bridge.recordings import artcult, motive_csv, qualisys, vicon_csv
from tracker_bridge.recordings.recording import Recording, Rows

FORMATS: dict[str, tuple[Callable[[Rows], bool], Callable[[Rows], Recording]]] = {
    "Vicon Tracker CSV": (vicon_csv.is_it, vicon_csv.read),
    "Motive CSV": (motive_csv.is_it, motive_csv.read),
    "Qualisys TSV of bodies": (qualisys.is_bodies, qualisys.read_bodies),
    "table of points": (qualisys.is_points, qualisys.read_points),
    "artificial culture log": (artcult.is_it, artcult.read),
}
"""A format adds one line: how it is known, and how it is read."""


def read_recording(path: Path) -> Recording:
    """UserError if the file cannot be read or is of no known format. `.gz` is unpacked."""
    rows = _rows(path)
    for name, (is_it, read) in FORMATS.items():
        if is_it(rows):
            try:
                recording = read(rows)
            except (ValueError, LookupError, ArithmeticError, StopIteration) as error:
                raise UserError(f"{path}: not a sound {name}: {error!r}") from error
            except UserError as error:
                raise UserError(f"{path}: {error}") from error
            return _not_empty(path, recording)
    raise UserError(f"{path}: no recording that is known; known: {', '.join(FORMATS)}, MCAP log")


def _rows(path: Path) -> Rows:
    """The cells; the byte-order mark and either kind of line end are gone."""
    try:
        data = path.read_bytes()
        lines = (gzip.decompress(data) if path.suffix == ".gz" else data).decode("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError, EOFError, zlib.error) as error:
        raise UserError(f"{path}: cannot be read as text: {error}") from error
    separator = "\t" if lines and "\t" in lines[0] else ","
    try:
        return list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        raise UserError(f"{path}: cannot be read as a table: {error}") from error


def _not_empty(path: Path, recording: Recording) -> Recording:
    if not any(moment.bodies for moment in recording.moments):
        raise UserError(f"{path}: nobody was seen in this recording")
    return recording
