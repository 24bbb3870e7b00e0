"""Whether a camera gives frames often enough, and in a light in which colours can be told."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np

from robot_agent.commands.preflight import Finding, Verdict
from robot_agent.drivers.cameras.fitted import TakeFrame
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import frame_pixels

CAMERA_TICKS = 50
"""Five seconds: the slowest camera, 40 x 40 over Bluetooth, gives some frames in them."""
LEAST_FRAMES_PER_S = 2.0
"""A demonstrator stands for 0.9 s at a corner, and has to be seen there twice."""
DARK, BRIGHT = 0.15, 0.85
"""Mean levels, of full scale; chosen: beyond them skirts are black or washed out."""
MOST_SATURATED = 0.2
"""Share of pixels with a channel at its end, where a colour is not known."""
FULL = 250
"""Of 255: five bits of a channel at their highest are 248 to 255."""


def camera_findings(
    take: TakeFrame, ticks: Iterator[int], now_s: Callable[[], float] = time.monotonic
) -> Iterator[Finding]:
    """Frame rate and exposure, from the frames of five seconds at ten looks a second."""
    began_s = now_s()
    frames = [frame for _ in islice(ticks, CAMERA_TICKS) if (frame := take())]
    rate_per_s = len(frames) / (now_s() - began_s)
    found = f"{rate_per_s:.1f} frames/s"
    if rate_per_s >= LEAST_FRAMES_PER_S:
        yield Finding("camera", Verdict.GOOD, f"{found}, {frames[-1].width} x {frames[-1].height}")
    else:
        cure = "a robot that watches needs more: use a camera on its board, or a shorter way to it"
        yield Finding("camera", Verdict.DOUBTFUL if frames else Verdict.BAD, found, cure)
    if frames:
        yield _exposure(frames[-1])


def _exposure(frame: Frame) -> Finding:
    pixels = np.asarray(frame_pixels(frame))
    level, saturated = float(pixels.mean()) / 255, float((pixels.max(axis=2) >= FULL).mean())
    found = f"mean level {level:.2f}, {100 * saturated:.0f} % of the pixels saturated"
    if level < DARK:
        return Finding("exposure", Verdict.DOUBTFUL, found, "more light, or a longer exposure")
    if level > BRIGHT or saturated > MOST_SATURATED:
        return Finding("exposure", Verdict.DOUBTFUL, found, "less light, or a shorter exposure")
    return Finding("exposure", Verdict.GOOD, found)
