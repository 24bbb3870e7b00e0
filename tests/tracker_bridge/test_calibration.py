"""Axes, unit, origin and turn found from a few known places; and why they cannot be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from swarm.errors import UserError
from swarm.geometry import Pose, wrap_angle_rad
from tracker_bridge.arena_frame import ArenaFrame
from tracker_bridge.calibration import Calibration, KnownPoint, calibrate

PLACES = [(0.2, 0.2), (2.8, 0.2), (2.8, 2.8), (0.2, 2.8), (1.5, 1.0)]


def frame(axes: str, unit_m: float) -> ArenaFrame:
    return ArenaFrame.of(axes, unit_m, (1.3, -0.4), 2.1)


def points(real: ArenaFrame, noise_m: float = 0.0) -> list[KnownPoint]:
    rng = np.random.default_rng(1)
    seen = [real.seen(Pose(*place, 0.0), 0.08)[0] for place in PLACES]
    noisy = [tuple(np.array(each) + rng.normal(0.0, noise_m / real.unit_m, 3)) for each in seen]
    return [KnownPoint((x, y, z), place) for (x, y, z), place in zip(noisy, PLACES, strict=True)]


def applied(calibration: Calibration) -> ArenaFrame:
    return ArenaFrame.of(calibration.axes, calibration.unit_m, calibration.origin_m, calibration.turn_rad)


@pytest.mark.parametrize("axes", ["x y z", "x -z y", "y z x", "-y -z x", "-x y -z"])
@pytest.mark.parametrize("unit_m", [1.0, 0.001, 0.0001])
def test_what_was_set_is_found(axes: str, unit_m: float) -> None:
    """Not the same words, for a half turn can be said twice, but the same mapping of place and heading."""
    real = frame(axes, unit_m)
    found = calibrate(points(real))
    assert found.unit_m == unit_m
    assert max(found.residuals_m) < 1e-9
    for pose in (Pose(0.5, 0.7, 0.3), Pose(2.0, 1.0, -2.0)):
        placed = applied(found).placed(*real.seen(pose, 0.08))
        assert placed.pose.distance_m(pose) < 1e-9
        assert placed.height_m == pytest.approx(0.08)


def test_errors_of_a_few_millimetres_are_borne_and_told() -> None:
    found = calibrate(points(frame("x y z", 0.001), noise_m=0.003))
    assert 0.001 < max(found.residuals_m) < 0.012
    assert wrap_angle_rad(found.turn_rad - 2.1) == pytest.approx(0.0, abs=math.radians(0.3))
    assert found.origin_m == pytest.approx((1.3, -0.4), abs=0.01)


def test_the_lines_for_the_experiment_file() -> None:
    assert calibrate(points(frame("x -z y", 1.0))).toml() == (
        'axes = "x -z y"\nunit_m = 1\norigin_m = [1.3000, -0.4000]\nturn_rad = 2.10000\n'
    )


def test_a_mirrored_floor_plan_is_named() -> None:
    mirrored = [
        replace(point, place_m=(point.place_m[1], point.place_m[0])) for point in points(frame("x y z", 1.0))
    ]
    with pytest.raises(UserError, match="fit only mirrored"):
        calibrate(mirrored)


def test_a_place_that_is_measured_wrongly_is_named() -> None:
    wrong = points(frame("x y z", 1.0))
    wrong[2] = replace(wrong[2], place_m=(2.8, 2.5))
    with pytest.raises(UserError, match="number 3 is"):
        calibrate(wrong)


@pytest.mark.parametrize(
    ("places", "said"),
    [
        ([(0.0, 0.0), (1.0, 0.0)], "at least 3 are needed"),
        ([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], "lie on a line"),
        ([(0.0, 0.0), (0.01, 0.0), (0.0, 0.01)], "too near together"),
    ],
)
def test_places_that_do_not_tell_are_named(places: list[tuple[float, float]], said: str) -> None:
    with pytest.raises(UserError, match=said):
        calibrate([KnownPoint((x, y, 0.08), (x, y)) for x, y in places])


def test_a_unit_that_is_none_is_named() -> None:
    feet = points(frame("x y z", 0.3048))
    with pytest.raises(UserError, match=r"one unit of the system would be 0\.3048 m"):
        calibrate(feet)
