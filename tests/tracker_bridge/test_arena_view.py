"""The arena for eyes: in characters and as a picture."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from swarm.config.experiment import ArenaSettings
from swarm.geometry import Pose
from tracker_bridge.arena_view import COLUMNS, MARGIN_PX, PIXELS_PER_M, in_characters, write_picture

ARENA = ArenaSettings(width_m=3.0, height_m=2.0)


def test_north_is_up_and_east_is_right() -> None:
    lines = in_characters({"one": [Pose(0.01, 0.01, 0.0)], "two": [Pose(1.5, 1.99, 0.0)]}, ARENA).splitlines()
    assert len(lines) == round(COLUMNS * 2 / 3 / 2) + 2
    assert lines[1].index("two") == 1 + COLUMNS // 2
    assert lines[-2].startswith("|one")


def test_names_stay_within_the_walls() -> None:
    text = in_characters({"at_the_edge": [Pose(2.99, 1.0, 0.0)], "out": [Pose(3.5, 1.0, 0.0)]}, ARENA)
    assert {len(line) for line in text.splitlines()} == {COLUMNS + 2}
    assert "out" not in text


def test_a_picture_shows_where_a_robot_drove(tmp_path: Path) -> None:
    track = [Pose(0.5 + 0.1 * step, 1.5, 0.0) for step in range(10)]
    write_picture(tmp_path / "tracks.png", {"r": track}, ARENA)
    picture = cv2.imread(str(tmp_path / "tracks.png"))
    assert picture is not None
    assert picture.shape[:2] == (2 * PIXELS_PER_M + 2 * MARGIN_PX, 3 * PIXELS_PER_M + 2 * MARGIN_PX)
    row = MARGIN_PX + round(0.5 * PIXELS_PER_M)
    drawn = np.flatnonzero(np.any(picture[row, MARGIN_PX + 5 : -MARGIN_PX - 5] != 255, axis=1)) + 5
    assert drawn.min() / PIXELS_PER_M < 0.51
    assert drawn.max() / PIXELS_PER_M > 1.39
