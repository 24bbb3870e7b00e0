"""The side edges of a skirt to a fraction of a pixel, in light rather than in the sensor's levels.

The rows around the horizon, where the white wall is behind the skirt, are averaged into one profile
across the image. An edge is where a sharp step between the plateaus on its two sides would hold as much
light as the profile does: that place does not depend on how blurred the edge is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.blobs import Blob
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.colour_table import PALE, ColourTable
from robot_agent.vision.pixels import Words, word_colours

REACH_PX = 3
"""Half the window around an edge; more than the blur, so that it holds the whole step."""
PLATEAU_PX = 5
"""Chosen: enough pixels on either side of the step for their noise to average out."""
MAX_SHIFT_PX = 3.0
"""Farther from the patch's border than the blur explains is the edge of another thing."""
MIN_PALE = 0.75
"""Chosen: of the wall beside an edge; the rest may be noise, but not another thing."""
MIN_STEP = 0.03
"""Of full scale; chosen: a lower step is no edge above the sensor's noise."""
BODY_ROWS = 3
"""How far up to look for the body: farther up, the dark may be what is above the wall."""
SHARP_ROWS = 10
"""A patch this high leaves out the row right above it, which the blur darkens above a post too."""
DARK_PART_OF_WALL = 0.6
"""Chosen: between a shaded wall, which is lighter, and an e-puck's body, which is darker."""
WALL_ROWS = 4
"""Chosen: some rows of wall right above the patch, few enough to stay below the wall's rim."""
RIM_ROWS = 2
"""The blur mixes into these the narrower body above the skirt and the shadow below it."""
ROWS_UP_PART = 1 / 24
"""Of the image's height above the horizon: farther up is no wall behind a robot that is near."""
ENOUGH_ROWS = 6
"""Chosen: so many rows average the noise of an edge of the smallest skirt that is seen."""
MOST_ROWS = 24
"""Chosen: more rows of a near skirt cost time and add no precision that the bearing could use."""


@dataclass(frozen=True)
class Edges:
    """Columns (fractions; pixel middles whole) of the two sides; None for a side that is not against wall."""

    left: float | None
    right: float | None


class EdgeFinder:
    """Finds the sides of a skirt in frames of one camera."""

    def __init__(self, model: CameraModel, table: ColourTable) -> None:
        self._model = model
        self._light = (word_colours()[:, table.edge_channel] ** model.gamma).astype(np.float32)
        self._pale = (table.kinds == PALE).astype(np.float32)

    def wall_light(self, words: Words) -> float:
        """How bright the wall is: the brighter part of the rows above the horizon."""
        row = int(self._model.horizon_row)
        light = self._light[words[row - WALL_ROWS : row, ::2]].ravel()
        return float(np.partition(light, -light.size // 4)[-light.size // 4])

    def has_body_above(self, words: Words, blob: Blob, wall_light: float) -> bool:
        """Whether it is dark right above a patch: a skirt has a robot's body above it, a post the wall."""
        last = max(blob.top - (1 if blob.height >= SHARP_ROWS else 0), 1)
        first = max(0, blob.top - BODY_ROWS)
        aside = blob.width // 4
        strip = words[first:last, blob.left + aside : blob.right - aside]
        return float(self._light[strip].mean(axis=1).min()) < DARK_PART_OF_WALL * wall_light

    def find(self, words: Words, blob: Blob) -> Edges:
        """The edges of a patch of skirt; its box may be wrong by two pixels."""
        band = words[self._rows(blob)]
        left = self._edge(band[:, : blob.left + blob.width // 2 + 1], blob.left)
        mirrored = band[:, ::-1][:, : self._model.width - (blob.right - 1) + blob.width // 2]
        right = self._edge(mirrored, self._model.width - blob.right)
        return Edges(left, None if right is None else self._model.width - 1 - right)

    def _rows(self, blob: Blob) -> slice:
        """Rows that surely show skirt against wall: an even number, to treat the Bayer rows alike."""
        highest = round(self._model.horizon_row - self._model.height * ROWS_UP_PART)
        first = max(blob.top + RIM_ROWS, highest)
        last = max(blob.top + blob.height // 2, first + ENOUGH_ROWS)
        last = min(last, blob.bottom - RIM_ROWS, highest + MOST_ROWS)
        if last - first < 2:
            first = min(max(blob.top + blob.height // 2 - 1, 0), self._model.height - 2)
            last = first + 2
        return slice(first, last - (last - first) % 2)

    def _edge(self, band: Words, start: int) -> float | None:
        """The left edge near column `start` of rows that end within the skirt."""
        edge = self._edge_at(band, start)
        if edge is not None and abs(edge + 0.5 - start) > 1:
            edge = self._edge_at(band, round(edge + 0.5))
        return edge if edge is not None and abs(edge + 0.5 - start) < MAX_SHIFT_PX else None

    def _edge_at(self, band: Words, start: int) -> float | None:
        """The edge within the window around `start`."""
        outside = slice(max(0, start - REACH_PX - PLATEAU_PX), start - REACH_PX)
        if start - REACH_PX < 2:
            return None
        near = np.ascontiguousarray(band[:, outside.start : start + REACH_PX + PLATEAU_PX])
        outer = outside.stop - outside.start
        if self._pale[near[:, max(0, outer - PLATEAU_PX + 1) : outer + 1]].mean() < MIN_PALE:
            return None
        profile = self._light[near].mean(axis=0)
        return _step(profile, outer, outside.start)


def _step(profile: NDArray[np.float32], first: int, offset: int) -> float | None:
    """Where the profile steps down after its `first` samples, all outside; `offset` is their first column."""
    last = min(first + 2 * REACH_PX, profile.size - 1)
    outer, inner = float(profile[:first].mean()), float(profile[last:].mean())
    if outer - inner < MIN_STEP:
        return None
    lit = (float(profile[first:last].sum()) - inner * (last - first)) / (outer - inner)
    return offset + first - 0.5 + lit
