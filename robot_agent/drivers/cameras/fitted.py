"""A camera as the agent wants it: of the calibration's size, in the run's time, noticed when it hangs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np

from robot_agent.drivers.notices import Say
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import frame_pixels

SAME_BEFORE_FROZEN = 5
"""No two exposures are the same to the last bit in a real room: so many in a row, and the camera hangs."""

TakeFrame = Callable[[], Frame | None]
"""The newest frame, its `t_ns` by the machine's monotonic clock; None if none came since the last call."""


class FittedCamera:
    """Any source of frames as a camera of the agent."""

    def __init__(
        self,
        take: TakeFrame,
        model: CameraModel,
        speed: float,
        say: Say,
        monotonic_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._take = take
        self._model = model
        self._speed = speed
        self._say = say
        self._monotonic_ns = monotonic_ns
        self._last = b""
        self._same = 0

    def capture(self, t_ns: int) -> Frame | None:
        """The newest frame, at the run's time of its exposure; None if there is none, or always the same."""
        frame = self._take()
        if frame is None or self._is_frozen(frame):
            return None
        age_ns = round((self._monotonic_ns() - frame.t_ns) * self._speed)
        return replace(fitted(frame, self._model), t_ns=t_ns - age_ns)

    def _is_frozen(self, frame: Frame) -> bool:
        self._same = self._same + 1 if frame.data == self._last else 0
        self._last = frame.data
        if self._same == SAME_BEFORE_FROZEN:
            self._say("camera", "the camera gives the same picture again and again: unplug it and plug it in")
        return self._same >= SAME_BEFORE_FROZEN


def fitted(frame: Frame, model: CameraModel) -> Frame:
    """The frame scaled to the model's size, as RGB565; as it is if it has that size."""
    if (frame.width, frame.height) == (model.width, model.height):
        return frame
    size = (model.width, model.height)
    return rgb565_frame(cv2.resize(frame_pixels(frame), size, interpolation=cv2.INTER_AREA), frame.t_ns)


def rgb565_frame(pixels: cv2.typing.MatLike, t_ns: int) -> Frame:
    """Red, green and blue, shape (height, width, 3), as a frame like an e-puck's: the high byte first."""
    packed = np.asarray(cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR565), dtype=np.uint8)
    height, width = packed.shape[:2]
    return Frame(t_ns, width, height, "rgb565", packed.view("<u2").byteswap().tobytes())
