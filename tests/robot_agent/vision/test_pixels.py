"""Raw formats, byte by byte."""

from __future__ import annotations

import numpy as np
import pytest

from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import frame_pixels, frame_words, word_colours


def test_rgb565_has_the_high_byte_first() -> None:
    red_green_blue_white = bytes([0xF8, 0x00, 0x07, 0xE0, 0x00, 0x1F, 0xFF, 0xFF])
    colours = word_colours()[frame_words(Frame(0, 4, 1, "rgb565", red_green_blue_white))][0]
    assert (colours > 0.9).tolist() == [
        [True, False, False],
        [False, True, False],
        [False, False, True],
        [True, True, True],
    ]


def test_yuyv_gives_the_words_of_the_same_colours() -> None:
    grey, red = [126, 128, 126, 128], [81, 90, 81, 240]
    frame = Frame(0, 4, 1, "yuyv", bytes(grey + red))
    colours = word_colours()[frame_words(frame)][0]
    assert colours[:2] == pytest.approx(0.5, abs=0.03)
    assert colours[2:].tolist() == [pytest.approx([0.98, 0.01, 0.02], abs=0.02)] * 2
    assert np.abs(frame_pixels(frame)[0] / 255 - colours).max() < 0.03


def test_a_frame_of_the_wrong_length_or_format_cannot_be_made() -> None:
    with pytest.raises(ValueError, match="16 bytes, not 8"):
        Frame(0, 4, 2, "rgb565", bytes(8))
    with pytest.raises(ValueError, match="jpeg"):
        Frame(0, 4, 2, "jpeg", bytes(16))


@pytest.mark.parametrize(("width", "height"), [(0, 0), (0, 4), (4, 0), (3, 2), (-2, -1)])
@pytest.mark.parametrize("pixel_format", ["rgb565", "yuyv"])
def test_a_frame_without_pixels_or_of_odd_width_cannot_be_made(
    width: int, height: int, pixel_format: str
) -> None:
    with pytest.raises(ValueError, match="the width must be even, and neither 0"):
        Frame(0, width, height, pixel_format, bytes(2 * width * height))
