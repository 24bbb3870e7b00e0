"""Frames as a sensor sends them, to and from plain arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

Words: TypeAlias = NDArray[np.uint16]
"""Pixels, shape (height, width), as the sensor's two bytes read by a little-endian machine."""

Pixels: TypeAlias = NDArray[np.uint8]
"""Pixels, shape (height, width, 3), red, green, blue, 0..255."""

WORDS = 1 << 16


def frame_words(frame: Frame) -> Words:
    """The pixels of a frame as 16-bit words: an index for tables over all the colours there are.

    The bytes of an RGB565 frame are taken as they stand, so the words are byte-swapped RGB565.
    """
    if frame.pixel_format == "yuyv":
        return _rgb565_from_yuyv(frame).byteswap()
    return np.frombuffer(frame.data, dtype="<u2").reshape(frame.height, frame.width)


def word_colours() -> NDArray[np.float32]:
    """Red, green and blue in 0..1 of every word, shape (65536, 3): the middle of each quantised level."""
    words = np.arange(WORDS, dtype=np.uint16).byteswap().astype(np.uint32)
    red, green, blue = words >> 11, (words >> 5) & 63, words & 31
    levels = [(red + 0.5) / 32, (green + 0.5) / 64, (blue + 0.5) / 32]
    return np.stack(levels, axis=1).astype(np.float32)


def frame_pixels(frame: Frame) -> Pixels:
    """The frame as red, green and blue, for people and pictures."""
    if frame.pixel_format == "yuyv":
        raw = np.frombuffer(frame.data, dtype=np.uint8).reshape(frame.height, frame.width, 2)
        return np.asarray(cv2.cvtColor(raw, cv2.COLOR_YUV2RGB_YUYV), dtype=np.uint8)
    colours = word_colours()[frame_words(frame)]
    return (colours * 255 + 0.5).astype(np.uint8)


def _rgb565_from_yuyv(frame: Frame) -> Words:
    raw = np.frombuffer(frame.data, dtype=np.uint8).reshape(frame.height, frame.width, 2)
    blue_green_red = cv2.cvtColor(raw, cv2.COLOR_YUV2BGR_YUYV)
    packed = cv2.cvtColor(blue_green_red, cv2.COLOR_BGR2BGR565)
    return np.asarray(packed, dtype=np.uint8).view("<u2").reshape(frame.height, frame.width)


BYTES_PER_PIXEL = 2


PIXEL_FORMATS = ("rgb565", "yuyv")


@dataclass(frozen=True)
class Frame:
    """One image as the sensor sent it, row by row from the top.

    `rgb565` has two bytes a pixel, the high byte first, as e-pucks send it; `yuyv` has Y0 U Y1 V for
    each two pixels. `t_ns` is the time of the exposure of the row at the horizon.
    """

    t_ns: int
    width: int
    height: int
    pixel_format: str
    data: bytes

    def __post_init__(self) -> None:
        if self.pixel_format not in PIXEL_FORMATS:
            raise ValueError(f"pixel format {self.pixel_format!r}: use one of {', '.join(PIXEL_FORMATS)}")
        expected = self.width * self.height * BYTES_PER_PIXEL
        if len(self.data) != expected:
            raise ValueError(
                f"a {self.width} x {self.height} frame has {expected} bytes, not {len(self.data)}"
            )
