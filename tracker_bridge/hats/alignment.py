"""Rigid alignment of points in the plane. Points are complex numbers, x + iy: a turn is a product."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]


def align(shapes: Points, points: Points, weights: Floats | None = None) -> tuple[Points, Points]:
    """The middles and turns (unit complex numbers) that take shapes (..., k) to points (..., k), no mirror.

    Weighted least squares (SE(2) Procrustes; Schoenemann 1966, in the complex plane):
    point = middle + turn * shape, where `middle` is where the shape's origin comes to lie.
    """
    weight = np.ones(points.shape) if weights is None else weights
    total = weight.sum(-1)
    shape_mean = (weight * shapes).sum(-1) / total
    point_mean = (weight * points).sum(-1) / total
    beside = weight * (points - point_mean[..., None])
    turn = (beside * (shapes - shape_mean[..., None]).conj()).sum(-1)
    turn = np.where(np.abs(turn) > 0, turn, 1.0)
    turn = turn / np.abs(turn)
    return np.asarray(point_mean - turn * shape_mean), np.asarray(turn)


def residuals(shapes: Points, points: Points) -> Floats:
    """(..., k): how far each point lies from its pin after the best alignment."""
    middle, turn = align(shapes, points)
    return np.asarray(np.abs(points - middle[..., None] - turn[..., None] * shapes))


def orders(pins: int) -> npt.NDArray[np.int64]:
    """(pins!, pins): every way to pair points with pins."""
    return np.array(list(permutations(range(pins))))
