"""The colour of a skirt as a table over all the colours a sensor can send."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.pixels import WORDS
from swarm.errors import UserError

OTHER, SKIRT, PALE = 0, 1, 2
MAX_FILE_BYTES = 1 << 18
"""Four times an uncompressed table of 64 Ki colours: a larger file is none."""


@dataclass(frozen=True)
class ColourTable:
    """What each 16-bit word of a frame (see `frame_words`) is: SKIRT, PALE (as the walls are) or OTHER.

    `edge_channel` (0 red, 1 green, 2 blue) is the one in which the skirt stands out best against a
    white wall. Red does not tell a red skirt from a white wall, and green does.
    """

    skirt: str
    kinds: NDArray[np.uint8]
    edge_channel: int

    def __post_init__(self) -> None:
        if self.kinds.shape != (WORDS,) or self.kinds.dtype != np.uint8 or self.kinds.max() > PALE:
            raise ValueError(f"the table must have {WORDS} bytes of 0, 1 or 2")
        if self.edge_channel not in (0, 1, 2):
            raise ValueError(f"edge channel {self.edge_channel} must be 0, 1 or 2")

    def save(self, path: Path | str) -> None:
        """Write the table to a new .npz file; UserError if the file is there already or cannot be made."""
        try:
            with Path(path).open("xb") as file:
                np.savez_compressed(
                    file,
                    skirt=np.frombuffer(self.skirt.encode(), dtype=np.uint8),
                    kinds=self.kinds,
                    edge_channel=np.array([self.edge_channel], dtype=np.uint8),
                )
        except FileExistsError as error:
            raise UserError(
                f"colour table {path} is there already: choose another name or remove it"
            ) from error
        except OSError as error:
            raise UserError(f"colour table {path}: {error}") from error


def load_colour_table(path: Path | str) -> ColourTable:
    """Read a table that `ColourTable.save` wrote; UserError, naming the file, if it is anything else."""
    try:
        _refuse_large(Path(path))
        with np.load(path, allow_pickle=False) as arrays:
            return ColourTable(
                skirt=arrays["skirt"].tobytes().decode(),
                kinds=arrays["kinds"],
                edge_channel=int(arrays["edge_channel"][0]),
            )
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise UserError(f"colour table {path} cannot be used: {error}; make it with calibrate") from error


def _refuse_large(path: Path) -> None:
    """A small file may unpack to a large one: look at both sizes before anything is read."""
    if path.stat().st_size > MAX_FILE_BYTES:
        raise ValueError(f"it is larger than {MAX_FILE_BYTES} bytes")
    with zipfile.ZipFile(path) as archive:
        if sum(member.file_size for member in archive.infolist()) > MAX_FILE_BYTES:
            raise ValueError(f"it unpacks to more than {MAX_FILE_BYTES} bytes")
