"""Where the rays of an emulated camera's pixels meet plates and bodies of robots."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]


def on_plate(
    origin: Floats, rays: Floats, centre: Floats, theta_rad: Floats, tilt_rad: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Where rays meet the plane of a plate: metres ahead of and to the left of its centre.

    `rays` is (..., 3) from `origin`; `centre` is (..., 3) and `theta_rad` (...), both at each ray's own time.
    """
    ahead, left = math.tan(tilt_rad[0]), math.tan(tilt_rad[1])
    cos, sin = np.cos(theta_rad), np.sin(theta_rad)
    east, north = centre[..., 0] - origin[0], centre[..., 1] - origin[1]
    # the plate sinks by `ahead` for each metre ahead and by `left` for each metre to the left
    slope_x, slope_y = ahead * cos - left * sin, ahead * sin + left * cos
    above = centre[..., 2] - origin[2] + slope_x * east + slope_y * north
    reach = above / (rays[..., 2] + slope_x * rays[..., 0] + slope_y * rays[..., 1])
    x, y = reach * rays[..., 0] - east, reach * rays[..., 1] - north
    return cos * x + sin * y, cos * y - sin * x


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
