"""Tags in photographs that others took, against corners that another library found; and in printed ones."""

from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from swarm.errors import UserError
from tracker_bridge.overhead.frames import read_picture
from tracker_bridge.overhead.tags import Tag, TagDetector, TagFamily

Floats = npt.NDArray[np.float64]

TAGS = Path(__file__).parents[2] / "data" / "tags"
PHOTOGRAPHS = {"33369213973_9d9bb4cc96_c": (12, 12), "34139872896_defdb2f8d9_c": (9, 10)}


def corners_given(name: str) -> list[Floats]:
    """The library counts pixels from the corner of the first, OpenCV from its middle."""
    lines = (TAGS / f"{name}.txt").read_text().splitlines()
    return [np.array(re.findall(r"\(([\d.]+) ([\d.]+)\)", line), dtype=float) - 0.5 for line in lines]


def missed_px(corners: Floats, tag: Tag) -> float:
    """The largest distance of a corner, whichever is the first and whichever way round they go."""
    orders = [np.roll(tag.corners[::way], first, 0) for way in (1, -1) for first in range(4)]
    return min(float(np.linalg.norm(order - corners, axis=1).max()) for order in orders)


@pytest.mark.parametrize("name", PHOTOGRAPHS)
def test_corners_in_photographs_are_where_another_library_puts_them(name: str) -> None:
    tags = TagDetector(TagFamily("36h11")).find(read_picture(TAGS / f"{name}.jpg"))
    misses = [min(missed_px(corners, tag) for tag in tags) for corners in corners_given(name)]
    wanted, there = PHOTOGRAPHS[name]
    assert len(misses) == there
    assert sum(miss < 2 for miss in misses) >= wanted
    assert np.median(misses) < 0.6
    assert {tag.id for tag in tags} == {0}, "every tag of the photographs has the id 0"


def test_ids_in_a_room_are_those_that_are_there() -> None:
    tags = TagDetector(TagFamily("36h11")).find(read_picture(TAGS / "test_image.png"))
    assert sorted(tag.id for tag in tags) == [60, 82, 318, 328, 387]


@pytest.mark.parametrize("family", ["4x4_50", "25h9", "16h5", "5x5_100"])
def test_another_family_reads_nothing_in_the_photographs(family: str) -> None:
    detector = TagDetector(TagFamily(family))
    for picture in TAGS.glob("*_c.jpg"):
        assert detector.find(read_picture(picture)) == []


def test_ids_that_a_laboratory_does_not_use_are_not_reported() -> None:
    tags = TagDetector(TagFamily("36h11", [82, 387, 400])).find(read_picture(TAGS / "test_image.png"))
    assert sorted(tag.id for tag in tags) == [82, 387]


@pytest.mark.parametrize("turns", range(4))
def test_corners_begin_at_the_upper_left_of_the_print(turns: int) -> None:
    family = TagFamily("36h11", [7, 8])
    tag = np.pad(np.kron(family.code(7), np.ones((5, 5))) * 200 + 25, 30, constant_values=225)
    picture = cv2.GaussianBlur(np.rot90(tag, turns).astype(np.uint8), (0, 0), 0.8)
    (found,) = TagDetector(family).find(np.asarray(picture, dtype=np.uint8))
    upright = np.array([[29.5, 29.5], [69.5, 29.5], [69.5, 69.5], [29.5, 69.5]])
    assert found.id == 7
    assert found.corners == pytest.approx(np.roll(upright, turns, 0), abs=0.1)


def test_random_modules_are_not_read() -> None:
    rng = np.random.default_rng(1)
    sheet = np.full((1000, 1000), 225, dtype=np.uint8)
    for row in range(15, 975, 60):
        for column in range(15, 975, 60):
            code = np.pad(rng.integers(0, 2, (6, 6)), 1)
            sheet[row : row + 40, column : column + 40] = np.kron(code, np.ones((5, 5))) * 200 + 25
    assert TagDetector(TagFamily("36h11")).find(sheet) == []


def test_a_family_refuses_what_it_does_not_have() -> None:
    with pytest.raises(UserError, match="did you mean '36h11'"):
        TagFamily("36h1")
    with pytest.raises(UserError, match=r"ids 0 to 49; asked for \[50\]"):
        TagFamily("4x4_50", [3, 50])
