"""Rigid alignment of points in the plane. Points are complex numbers, x + iy: a turn is a product."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def align(shapes: Points, points: Points, seen: Mask | None = None) -> tuple[Points, Points]:
    """The middles and turns (unit complex numbers) that take shapes (..., k) to points (..., k), no mirror.

    Least squares over the pins that are `seen` (SE(2) Procrustes; Schoenemann 1966 in the complex plane):
    point = middle + turn * shape, where `middle` is where the shape's origin comes to lie.
    """
    weight = np.ones(points.shape) if seen is None else seen.astype(np.float64)
    total = np.maximum(weight.sum(-1), 1.0)
    shape_mean = (weight * shapes).sum(-1) / total
    point_mean = (weight * np.where(weight > 0, points, 0)).sum(-1) / total
    turned = np.where(weight > 0, points, 0) - point_mean[..., None]
    turn = (weight * turned * (shapes - shape_mean[..., None]).conj()).sum(-1)
    turn = np.where(np.abs(turn) > 0, turn, 1.0)
    turn = turn / np.abs(turn)
    return point_mean - turn * shape_mean, turn


def residuals(shapes: Points, points: Points, seen: Mask | None = None) -> Floats:
    """(..., k): how far each point lies from its pin after the best alignment; 0 where it is not seen."""
    middle, turn = align(shapes, points, seen)
    miss = np.abs(points - middle[..., None] - turn[..., None] * shapes)
    return np.asarray(miss if seen is None else np.where(seen, miss, 0.0))


def orders(pins: int) -> npt.NDArray[np.int64]:
    """(pins!, pins): every way to pair points with pins."""
    return np.array(list(permutations(range(pins))))
