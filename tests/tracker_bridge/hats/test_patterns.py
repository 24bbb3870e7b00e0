"""Patterns of pins: how different they are, and sets of them."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from swarm.errors import UserError
from tracker_bridge.hats.alignment import Points
from tracker_bridge.hats.design import design_hats
from tracker_bridge.hats.examination import examine
from tracker_bridge.hats.patterns import Hat, PinGrid, difference_m, every_pattern, self_difference_m

KITE = np.array([[0.03, 0.01j, -0.01j, -0.02]])


def moved(pins: Points, turn_rad: float = 1.0, shift: complex = 0.4 - 0.2j) -> Points:
    return np.asarray(pins * cmath.exp(1j * turn_rad) + shift)


def test_a_pattern_that_is_turned_moved_and_renumbered_is_the_same() -> None:
    assert difference_m(KITE, moved(KITE)[:, [2, 0, 3, 1]]) == pytest.approx(np.zeros((1, 1)), abs=1e-12)


def test_a_mirror_image_is_another_pattern() -> None:
    skew = np.array([[0.03, 0.02j, -0.01j, -0.02 + 0.01j]])
    assert difference_m(skew, skew.conj())[0, 0] > 0.003


def test_the_difference_is_the_largest_miss_after_the_best_fit() -> None:
    """Two pins 40 mm and 46 mm apart fit with each pin 3 mm off."""
    assert difference_m(np.array([[0j, 0.040]]), np.array([[0j, 0.046]])) == pytest.approx(0.003)


def test_a_square_looks_the_same_turned_round() -> None:
    square = np.array([[0.02, 0.02j, -0.02, -0.02j]])
    assert self_difference_m(square) == pytest.approx(0.0, abs=1e-12)
    assert self_difference_m(np.array([[0.03, 0.02j, -0.01j, -0.02 + 0.01j]])) > 0.002


def test_the_usual_grid_fits_an_epuck() -> None:
    holes = PinGrid().holes
    assert len(holes) == 21
    assert max(abs(hole) for hole in holes) <= 0.034


def test_each_kind_of_pattern_is_there_once() -> None:
    patterns = every_pattern(PinGrid(3, 3, 0.01), 2, 0.01)
    assert len(patterns) == 6, "1, 2, sqrt 2 and sqrt 8 pitches apart, and sqrt 5 in two directions"


def test_a_hundred_hats_differ_by_five_millimetres() -> None:
    hats = design_hats(PinGrid(), 100)
    examination = examine(hats, 0.005)
    assert examination.findings == ()
    assert examination.least_difference_m >= 0.0065, "what the search finds; 5 mm are needed"
    assert {hat.name for hat in hats} == {str(number) for number in range(1, 101)}


def test_more_hats_than_there_are_patterns_are_refused() -> None:
    with pytest.raises(UserError, match=r"the grid has \d+ patterns that differ at all; 500 were asked for"):
        design_hats(PinGrid(4, 4, 0.014), 500)


def test_what_could_be_mistaken_is_named() -> None:
    one = Hat("a", (0.03, 0.02j, -0.01j, -0.02 + 0.01j))
    near = Hat("b", tuple(pin + (0.002 if number == 0 else 0) for number, pin in enumerate(one.pins)))
    square = Hat("c", tuple(0.02 * 1j**number for number in range(4)))
    crowded = Hat("d", (0.03, 0.02j, 0.02j + 0.005, -0.03j))
    text = "\n".join(examine([one, near, square, crowded], 0.005).findings)
    assert "hats a and b differ by" in text
    assert "hat c looks the same turned round" in text
    assert "hat d has pins 5.0 mm apart" in text
    assert "hats a and c" not in text
    assert math.isclose(
        examine([one, near], 0.0).least_difference_m, examine([near, one], 0.0).least_difference_m
    )
