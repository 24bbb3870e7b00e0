"""The labelled ball of real pictures as a target: found at its place or not seen, and nothing else is found.

A sphere's outline is as wide and as high as a cylinder's. The ball is 7 to 13 pixels wide and lies on a green
floor, which is neither white nor grey: to refuse it is right.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Demonstrator, Skirt
from robot_agent.vision.detector import Detection, Detector, NotSeen
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import frame_words, word_colours
from robot_agent.vision.skirt_colour import SkirtColour
from robot_agent.vision.white_balance import WhiteBalance
from swarm.config.experiment import CopyProfile

PICTURES = Path(__file__).parents[2] / "data" / "balls"
LABELS = {
    "ball-2019.jpg": (220.1, 121.0, 8.3, 9.5),
    "ball-2022.jpg": (220.0, 120.9, 12.6, 14.5),
    "ball-2024.jpg": (220.4, 120.1, 6.9, 7.3),
}
"""Column, row, width and height of the ball in each picture, as people have drawn its box."""
MODEL = CameraModel(320, 240, 0.93, gamma=2.2, forward_m=0.0, height_m=0.11)
LIGHT = (word_colours() ** MODEL.gamma).astype(np.float32)


@pytest.mark.parametrize("first_column", [0, 60, 120])
@pytest.mark.parametrize("picture", LABELS)
def test_the_ball_is_found_at_its_place_or_not_seen(picture: str, first_column: int) -> None:
    column, row, width, height = LABELS[picture]
    column -= first_column
    frame = cut(picture, first_column)
    words = frame_words(frame)
    white = WhiteBalance(MODEL, LIGHT, (1.0, 1.0, 1.0)).follow(words)
    box = (
        slice(round(row - height / 4), round(row + height / 4)),
        slice(round(column - 2), round(column + 2)),
    )
    red, green, blue = (float(part) for part in np.median(LIGHT[words[box]] / white, axis=(0, 1)).clip(0, 2))
    ball = Skirt("ball", 0.11, 0.0, 0.22, (red, green, blue), hue_tolerance_rad=0.5)
    is_ball = SkirtColour(ball, LIGHT, 0.38).table(white)[words]
    assert is_ball[box].mean() > 0.5, "its colour is known"
    answer = Detector(CopyProfile.BEST, MODEL, Demonstrator(ball)).look(frame)
    if isinstance(answer, Detection):
        middle = np.mean([side for side in (answer.left_px, answer.right_px) if side is not None])
        assert middle == pytest.approx(column, abs=width)
    else:
        assert isinstance(answer, NotSeen)
        assert answer.reason.value


@pytest.mark.parametrize("first_column", [0, 60, 120])
@pytest.mark.parametrize("picture", LABELS)
@pytest.mark.parametrize("colour", [(0.66, 0.05, 0.04), (0.6, 0.06, 0.4)], ids=["red", "magenta"])
def test_nothing_in_a_hall_is_taken_for_a_demonstrator(
    picture: str, first_column: int, colour: tuple[float, float, float]
) -> None:
    """There are red posters and people in red in them, but no robot with a skirt."""
    detector = Detector(CopyProfile.BEST, MODEL, Demonstrator(Skirt(colour=colour)))
    assert isinstance(detector.look(cut(picture, first_column)), NotSeen)


def cut(picture: str, first_column: int) -> Frame:
    """A part of a picture as a camera would send it."""
    pixels = cv2.imread(str(PICTURES / picture))
    assert pixels is not None
    part = np.ascontiguousarray(pixels[:, first_column : first_column + MODEL.width])
    packed = cv2.cvtColor(part, cv2.COLOR_BGR2BGR565).reshape(MODEL.height, MODEL.width, 2)
    return Frame(0, MODEL.width, MODEL.height, "rgb565", packed[:, :, ::-1].tobytes())
