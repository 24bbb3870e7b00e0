"""Colour tables, in which calibration kept a skirt's colour before it wrote whole files; still readable."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.demonstrator import Colour, Demonstrator, Skirt
from robot_agent.vision.pixels import WORDS, word_colours
from swarm.errors import UserError

SKIRT, PALE = 1, 2
"""What a table says of a 16-bit word of a frame (see `frame_words`); PALE is as the walls are."""
MAX_FILE_BYTES = 1 << 18
"""Four times an uncompressed table of 64 Ki colours: a larger file is none."""


def load_colour_table(path: Path | str, gamma: float) -> Demonstrator:
    """The demonstrator of an .npz table; UserError, naming the file, if it is anything else."""
    try:
        _refuse_large(Path(path))
        with np.load(path, allow_pickle=False) as arrays:
            return _demonstrator(arrays["skirt"].tobytes().decode(), arrays["kinds"], gamma)
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise UserError(f"colour table {path} cannot be used: {error}; make a file with calibrate") from error


def _demonstrator(name: str, kinds: NDArray[np.uint8], gamma: float) -> Demonstrator:
    """The walls' colour is in the middle of what is pale, the skirt's in the middle of what is skirt."""
    if kinds.shape != (WORDS,) or kinds.dtype != np.uint8 or kinds.max() > PALE:
        raise ValueError(f"the table must have {WORDS} bytes of 0, 1 or 2")
    if not ((kinds == SKIRT).any() and (kinds == PALE).any()):
        raise ValueError("the table knows no colour of a skirt, or none of a wall")
    light = word_colours() ** gamma
    white = np.median(light[kinds == PALE], axis=0)
    return Demonstrator(
        Skirt(name, colour=_colour(np.median(light[kinds == SKIRT], axis=0) / white)), None, _colour(white)
    )


def _colour(light: NDArray[np.floating]) -> Colour:
    red, green, blue = (float(part) for part in np.clip(light, 0, 2))
    return red, green, blue


def _refuse_large(path: Path) -> None:
    """A small file may unpack to a large one: look at both sizes before anything is read."""
    if path.stat().st_size > MAX_FILE_BYTES:
        raise ValueError(f"it is larger than {MAX_FILE_BYTES} bytes")
    with zipfile.ZipFile(path) as archive:
        if sum(member.file_size for member in archive.infolist()) > MAX_FILE_BYTES:
            raise ValueError(f"it unpacks to more than {MAX_FILE_BYTES} bytes")
