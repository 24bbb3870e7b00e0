"""Where the rays of an emulated camera's pixels meet plates and bodies of robots."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]


def on_plate(
    origin: Floats, rays: Floats, centre: Floats, theta_rad: Floats, tilt_rad: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Where rays meet a plate: metres ahead of and to the left of its centre, along the plate.

    `rays` is (..., 3) from `origin`; `centre` is (..., 3) and `theta_rad` (...), both at each ray's own time.
    The plate's front sinks by the first tilt, then its left side by the second.
    """
    cos, sin = np.cos(theta_rad), np.sin(theta_rad)
    ahead, left, up = _plate_axes(*tilt_rad)
    from_centre = _in_heading(origin - centre, cos, sin)
    along = _in_heading(rays, cos, sin)
    reach = -_dot(from_centre, up) / _dot(along, up)
    met = [start + reach * step for start, step in zip(from_centre, along, strict=True)]
    return _dot(met, ahead), _dot(met, left)


def _plate_axes(pitch_rad: float, roll_rad: float) -> list[list[float]]:
    """A plate's own ahead, left and up before it turns to its heading."""
    cp, sp, cr, sr = math.cos(pitch_rad), math.sin(pitch_rad), math.cos(roll_rad), math.sin(roll_rad)
    return [[cp, 0.0, -sp], [-sp * sr, cr, -cp * sr], [sp * cr, sr, cp * cr]]


def _in_heading(vectors: Floats, cos: Floats, sin: Floats) -> list[Floats]:
    """The three parts of vectors (..., 3): ahead of and to the left of a heading, and up."""
    x, y = vectors[..., 0], vectors[..., 1]
    return [cos * x + sin * y, cos * y - sin * x, vectors[..., 2]]


def _dot(parts: list[Floats], axis: list[float]) -> Floats:
    first, second, third = (np.float32(weight) for weight in axis)
    return np.asarray(parts[0] * first + parts[1] * second + parts[2] * third)


def through_body(origin: Floats, rays: Floats, centre: Floats, radius_m: float) -> npt.NDArray[np.bool_]:
    """Which rays pass through a cylinder that stands on the floor below a plate."""
    reach = (0.0 - origin[2]) / rays[..., 2]
    foot_x, foot_y = origin[0] + reach * rays[..., 0], origin[1] + reach * rays[..., 1]
    reach = (centre[..., 2] - origin[2]) / rays[..., 2]
    step_x = origin[0] + reach * rays[..., 0] - foot_x
    step_y = origin[1] + reach * rays[..., 1] - foot_y
    from_x, from_y = centre[..., 0] - foot_x, centre[..., 1] - foot_y
    along = (from_x * step_x + from_y * step_y) / np.maximum(step_x**2 + step_y**2, 1e-12)
    nearest = np.clip(along, 0.0, 1.0)
    miss = (from_x - nearest * step_x) ** 2 + (from_y - nearest * step_y) ** 2
    return np.asarray(miss < radius_m**2)
