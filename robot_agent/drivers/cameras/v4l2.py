"""A camera on the robot's board: YUYV or UYVY of 640 x 480, streaming or by plain read().

Needs linuxpy (the `camera` extra). Not tried with a device: the machine that this was written on has none.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from robot_agent.drivers.cameras.fitted import TakeFrame
from robot_agent.vision.frames import Frame
from swarm.errors import UserError

WIDTH, HEIGHT = 640, 480
"""What e-pucks' sensors and the paper's board give; scaled to the calibration's size afterwards."""
FORMATS = ("YUYV", "UYVY")
FIXED_CONTROLS = {"auto_exposure": 1, "white_balance_automatic": 0, "exposure_auto": 1}
"""Automatic exposure and white balance change the colours that the skirts are told by; 1 is manual."""


def v4l2_frames(device: str) -> TakeFrame:
    """The newest frame of a device such as /dev/video0. UserError if it cannot be opened."""
    try:
        from linuxpy.video.device import Device
    except ModuleNotFoundError as error:
        raise UserError(f"camera {device}: needs linuxpy: pip install 'swarm-runtime[camera]'") from error
    try:
        camera = Device(device)
        camera.open()
        format_name = _with_format(camera)
    except OSError as error:
        raise UserError(f"camera {device}: cannot be opened ({error}); is it plugged in?") from error
    _fix_colours(camera)
    return Newest(_frames(camera, format_name)).take


class Newest:
    """Reads frames on a thread and keeps the newest."""

    def __init__(self, frames: Iterator[Frame]) -> None:
        self._frames = frames
        self._newest: Frame | None = None
        self._lock = threading.Lock()
        threading.Thread(target=self._read, daemon=True).start()

    def take(self) -> Frame | None:
        """The newest frame; None if none came since the last call, as when the camera is unplugged."""
        with self._lock:
            frame, self._newest = self._newest, None
        return frame

    def _read(self) -> None:
        with suppress(OSError):
            for frame in self._frames:
                with self._lock:
                    self._newest = frame


def frame_of(data: bytes, width: int, height: int, format_name: str, t_ns: int) -> Frame:
    """A frame of a sensor's bytes; UYVY has each two bytes the other way round than YUYV."""
    if format_name == "UYVY":
        data = np.frombuffer(data, dtype="<u2").byteswap().tobytes()
    return Frame(t_ns, width, height, "yuyv", data)


def _with_format(camera: object) -> str:
    """Set the first format that the device takes."""
    from linuxpy.video.device import BufferType, PixelFormat

    for name in FORMATS:
        with suppress(OSError):
            camera.set_format(BufferType.VIDEO_CAPTURE, WIDTH, HEIGHT, name)  # type: ignore[attr-defined]
            if camera.get_format(BufferType.VIDEO_CAPTURE).pixel_format == PixelFormat[name]:  # type: ignore[attr-defined]
                return name
    raise OSError(f"it has neither of {', '.join(FORMATS)} at {WIDTH} x {HEIGHT}")


def _fix_colours(camera: object) -> None:
    """Where the camera allows it."""
    controls = camera.controls  # type: ignore[attr-defined]
    for name, value in FIXED_CONTROLS.items():
        with suppress(AttributeError, KeyError, OSError, ValueError):
            getattr(controls, name).value = value


def _frames(camera: object, format_name: str) -> Iterator[Frame]:
    """Frames with the driver's own time stamp, which Linux takes from the monotonic clock."""
    from linuxpy.video.device import VideoCapture

    with VideoCapture(camera) as capture:
        for frame in capture:
            t_ns = round(frame.timestamp * 1e9)
            yield frame_of(bytes(frame), frame.width, frame.height, format_name, t_ns)
