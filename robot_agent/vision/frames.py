"""One image as a camera sent it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

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
        if self.width < 2 or self.height < 1 or self.width % 2:
            raise ValueError(f"a {self.width} x {self.height} frame: the width must be even, and neither 0")
        expected = self.width * self.height * BYTES_PER_PIXEL
        if len(self.data) != expected:
            raise ValueError(
                f"a {self.width} x {self.height} frame has {expected} bytes, not {len(self.data)}"
            )


HASH_BYTES = 8
"""Of a day's frames, at five a second, two have the same by chance once in 200 million days."""


def frame_hash(frame: Frame) -> int:
    """Of the bytes, as the log has it (`Look.frame_hash`)."""
    return int.from_bytes(hashlib.blake2b(frame.data, digest_size=HASH_BYTES).digest(), "little")
