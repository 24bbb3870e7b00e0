"""Raw sensor formats to and from plain arrays."""

from __future__ import annotations

from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.frames import Frame

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
