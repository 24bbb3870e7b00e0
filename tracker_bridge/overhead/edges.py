"""The outer edges of tags to a fraction of a pixel, for many tags at once.

An edge is looked for along lines across it: from the black border outwards to the white margin the grey value
rises. First each side moves as a whole to the steepest rise of its mean profile, then a line is fitted
to the centroids of the rises along it; corners are where neighbouring lines meet.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

ALONG = np.linspace(0.1, 0.9, 9)
"""Where the edge is looked for, in parts of a side: corners are rounded by the lens."""
ACROSS = np.linspace(-1.0, 1.0, 15)
"""Samples across, in parts of the reach."""
FINE_MODULES, FINE_LEAST_PX, FINE_MOST_PX = 0.6, 1.0, 1.5
"""Reach of the centroid: within the border's own module, and wide enough for the blur of a lens."""

FINE_ROUNDS = 3
"""Samples then lie evenly about the edges; on rendered frames a fourth round changed nothing."""


def aligned_quads(picture: Grey, quads: Floats, reach_px: float, modules: int) -> Floats:
    """(n, 4, 2): quadrilaterals moved onto the edges of tags that are within `reach_px` of them.

    `quads` are (n, 4, 2), clockwise; a tag has so many `modules` along its side.
    """
    module_px = _depth_px(quads) / modules
    fine_px = np.clip(FINE_MODULES * module_px, FINE_LEAST_PX, FINE_MOST_PX)
    quads = _meeting(*_moved_sides(picture, quads, np.full(module_px.shape, reach_px)))
    for _ in range(FINE_ROUNDS):
        quads = _meeting(*_fitted_sides(picture, quads, fine_px))
    return quads


def _depth_px(quads: Floats) -> Floats:
    """(n, 4): how far quads reach across from each side; little where a tag is seen aslant."""
    side = np.roll(quads, -1, 1) - quads
    diagonal = quads[:, 2:] - quads[:, :2]
    area = np.abs(diagonal[:, 0, 0] * diagonal[:, 1, 1] - diagonal[:, 0, 1] * diagonal[:, 1, 0]) / 2
    return np.asarray(area[:, None] / (np.linalg.norm(side, axis=-1) + 1e-9))


def _moved_sides(picture: Grey, quads: Floats, reach_px: Floats) -> tuple[Floats, Floats]:
    """Both ends of each side, moved across to the steepest rise of its mean profile."""
    rises, offsets_px, outward = _rises(picture, quads, reach_px)
    steepest = rises.mean(2).argmax(-1)
    moved_px = np.take_along_axis(offsets_px, steepest[..., None], -1)[..., 0]
    shift = moved_px[..., None] * outward
    return quads + shift, np.roll(quads, -1, 1) + shift


def _fitted_sides(picture: Grey, quads: Floats, reach_px: Floats) -> tuple[Floats, Floats]:
    """Both ends of each side, of the line through the centroids of the rises across it."""
    rises, offsets_px, outward = _rises(picture, quads, reach_px)
    rises = np.maximum(rises, 0.0)
    weight = rises.sum(-1) + 1e-9
    centroid_px = (rises * offsets_px[:, :, None]).sum(-1) / weight
    mean = (weight * ALONG).sum(-1) / weight.sum(-1)
    lever = ALONG - mean[..., None]
    level_px = (weight * centroid_px).sum(-1) / weight.sum(-1)
    slope_px = (weight * lever * centroid_px).sum(-1) / (weight * lever**2).sum(-1)
    first_px, last_px = level_px - slope_px * mean, level_px + slope_px * (1 - mean)
    return quads + first_px[..., None] * outward, np.roll(quads, -1, 1) + last_px[..., None] * outward


def _rises(picture: Grey, quads: Floats, reach_px: Floats) -> tuple[Floats, Floats, Floats]:
    """Rises of the grey value outwards (n, 4, along, across), their offsets (n, 4, across) and the sides'
    outward normals (n, 4, 2)."""
    side = np.roll(quads, -1, 1) - quads
    outward = np.stack([side[..., 1], -side[..., 0]], -1)
    outward /= np.linalg.norm(outward, axis=-1, keepdims=True) + 1e-9
    across_px = reach_px[..., None] * ACROSS
    on_edge = quads[:, :, None] + ALONG[:, None] * side[:, :, None]
    points = on_edge[:, :, :, None] + across_px[:, :, None, :, None] * outward[:, :, None, None]
    return np.diff(sampled(picture, points), axis=-1), (across_px[..., 1:] + across_px[..., :-1]) / 2, outward


def sampled(picture: Grey, points: Floats) -> Floats:
    """Grey values at (n, ..., 2) pixels, between pixels linearly; beyond the picture its edge goes on."""
    across, down = points.reshape(len(points), -1, 2).astype(np.float32).transpose(2, 0, 1).copy()
    grey = cv2.remap(picture, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(grey, dtype=np.float64).reshape(points.shape[:-1])


def _meeting(first: Floats, last: Floats) -> Floats:
    """(n, 4, 2): where each side's line, through its two ends, meets the line of the side before."""
    ones = np.ones((*first.shape[:2], 1))
    line = np.cross(np.concatenate([first, ones], -1), np.concatenate([last, ones], -1))
    corner = np.cross(np.roll(line, 1, 1), line)
    return np.asarray(corner[..., :2] / corner[..., 2:])
