"""Where a tracking system's axes lie in the arena, from a few places that are known in both.

A body is put at known places and the system says where it saw it. The axis that is up is the one that
hardly changed; the unit is the one that makes distances agree; the rest is a rigid fit (Kabsch, 1976).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from tracker_bridge.arena_frame import Axis, handedness
from tracker_bridge.protocols.cursor import Vector

UNITS_M = (1.0, 0.01, 0.001, 0.0001)
"""Metres, centimetres, millimetres, and the tenths of the first laboratory."""
UNIT_SLACK = 0.1
"""Tape measures are right within 1 %; the units are 10 apart."""
FEWEST_POINTS = 3
"""Two fit any turn and its mirror image."""
LEAST_SPREAD_M = 0.3
"""Nearer together, 5 mm of error turn the arena by more than a degree."""
GOOD_FIT_M = 0.02

Points = npt.NDArray[np.float64]


@dataclass(frozen=True)
class KnownPoint:
    """A place in the system's own axes and unit, and in the arena."""

    seen: Vector
    place_m: tuple[float, float]


@dataclass(frozen=True)
class Calibration:
    """The [tracker] table's settings, and how far each point is from where they put it."""

    axes: str
    unit_m: float
    origin_m: tuple[float, float]
    turn_rad: float
    residuals_m: tuple[float, ...]

    def toml(self) -> str:
        """The lines for the experiment's [tracker] table."""
        x_m, y_m = self.origin_m
        return (
            f'axes = "{self.axes}"\nunit_m = {self.unit_m:g}\n'
            f"origin_m = [{x_m:.4f}, {y_m:.4f}]\nturn_rad = {self.turn_rad:.5f}\n"
        )


def calibrate(points: Sequence[KnownPoint]) -> Calibration:
    """The settings that put what was seen where it was; UserError if the points do not tell."""
    seen = np.array([point.seen for point in points], dtype=float)
    places_m = np.array([point.place_m for point in points], dtype=float)
    _check(places_m)
    east, north, up = _axes(seen)
    flat = np.stack([sign * seen[:, axis] for axis, sign in (east, north)], axis=1)
    unit_m = _unit(flat, places_m)
    turn_rad, origin_m, residuals_m = _rigid_fit(unit_m * flat, places_m)
    if max(residuals_m) > GOOD_FIT_M:
        raise UserError(_why_it_does_not_fit(unit_m * flat, places_m, residuals_m))
    return Calibration(_named((east, north, up)), unit_m, origin_m, turn_rad, residuals_m)


def _check(places_m: Points) -> None:
    if len(places_m) < FEWEST_POINTS:
        raise UserError(f"{len(places_m)} known places; at least {FEWEST_POINTS} are needed")
    spread_m = np.linalg.svd(places_m - places_m.mean(axis=0), compute_uv=False)
    if spread_m[-1] < LEAST_SPREAD_M / 2:
        raise UserError("the places lie on a line or too near together: take three corners of the arena")


def _axes(seen: Points) -> tuple[Axis, Axis, Axis]:
    """The up axis changed least; its sign is that of the heights, since nobody tracks below the floor."""
    up = int(np.argmin(np.ptp(seen, axis=0)))
    up_sign = -1 if seen[:, up].mean() < 0 else 1
    east, north = sorted({0, 1, 2} - {up})
    axes: tuple[Axis, Axis, Axis] = ((east, 1), (north, 1), (up, up_sign))
    return axes if handedness(axes) > 0 else ((east, 1), (north, -1), (up, up_sign))


def _unit(flat: Points, places_m: Points) -> float:
    pairs = list(combinations(range(len(flat)), 2))
    ratio = float(np.median([_apart(places_m, *pair) / max(_apart(flat, *pair), 1e-12) for pair in pairs]))
    unit_m = min(UNITS_M, key=lambda unit: abs(math.log(ratio / unit)))
    if abs(ratio / unit_m - 1.0) > UNIT_SLACK:
        raise UserError(f"one unit of the system would be {ratio:.4g} m: are the places measured right?")
    return unit_m


def _apart(points: Points, one: int, other: int) -> float:
    return float(np.linalg.norm(points[one] - points[other]))


def _rigid_fit(flat_m: Points, places_m: Points) -> tuple[float, tuple[float, float], tuple[float, ...]]:
    """The turn and the origin for which squared distances are least, and the distances; no mirroring."""
    one, other = flat_m - flat_m.mean(axis=0), places_m - places_m.mean(axis=0)
    along = float(np.sum(one * other))
    across = float(np.sum(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]))
    turn_rad = math.atan2(across, along)
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    turned = flat_m @ np.array([[cos, sin], [-sin, cos]])
    x_m, y_m = (places_m - turned).mean(axis=0).tolist()
    residuals_m = np.linalg.norm(turned + np.array([x_m, y_m]) - places_m, axis=1)
    return turn_rad, (x_m, y_m), tuple(residuals_m.tolist())


def _why_it_does_not_fit(flat_m: Points, places_m: Points, residuals_m: Sequence[float]) -> str:
    if max(_rigid_fit(flat_m * np.array([1.0, -1.0]), places_m)[2]) <= GOOD_FIT_M:
        return "the places fit only mirrored: is x taken for y, or are the places those of another corner?"
    worst = int(np.argmax(residuals_m))
    return (
        f"the places do not fit: number {worst + 1} is {1000 * residuals_m[worst]:.0f} mm off; measure again"
    )


def _named(axes: tuple[Axis, Axis, Axis]) -> str:
    return " ".join(("-" if sign < 0 else "") + "xyz"[axis] for axis, sign in axes)
