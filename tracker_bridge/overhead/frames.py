"""Where a camera's pictures come from: a camera, a video, a folder of pictures, or an iterator."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from swarm.clock import NS_PER_S
from swarm.errors import UserError

Grey = npt.NDArray[np.uint8]

PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm")
USUAL_RATE_HZ = 30.0
"""Of a folder of pictures, which does not say."""
UNPLUGGED_S = 0.1
"""How long a camera that gives no picture is left alone; the bridge tells meanwhile that robots are lost."""


@dataclass(frozen=True)
class Frame:
    """A grey picture (height, width) and the run's time at which it was taken."""

    picture: Grey
    captured_t_ns: int


class FrameSource(Protocol):
    """Gives each picture once."""

    def frames(self, t_ns: int) -> list[Frame]:
        """What was taken up to the run's time `t_ns` and not given yet; it never waits for a picture."""

    def close(self) -> None:
        """Let go of the camera or the file."""


class RecordedFrames:
    """Pictures at a steady rate; the first is taken when the first is asked for."""

    def __init__(self, pictures: Iterable[Grey], rate_hz: float) -> None:
        self._pictures: Iterator[Grey] = iter(pictures)
        self._period_ns = NS_PER_S / rate_hz
        self._began_ns: int | None = None
        self._given = 0

    def frames(self, t_ns: int) -> list[Frame]:
        if self._began_ns is None:
            self._began_ns = t_ns
        frames = []
        while (due_ns := self._began_ns + round(self._given * self._period_ns)) <= t_ns:
            picture = next(self._pictures, None)
            if picture is None:
                break
            self._given += 1
            frames.append(Frame(picture, due_ns))
        return frames

    def close(self) -> None:
        self._pictures = iter(())


class LiveFrames:
    """A camera that is read by a thread of its own; a picture that comes too late to be looked at is dropped.

    `delay_s` is from exposure to receipt: most cameras at 30 frames/s take one to two frames.
    """

    def __init__(self, capture: cv2.VideoCapture, delay_s: float) -> None:
        self._capture = capture
        self._delay_ns = round(delay_s * NS_PER_S)
        self._newest: tuple[Grey, int] | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def frames(self, t_ns: int) -> list[Frame]:
        newest, self._newest = self._newest, None
        if newest is None:
            return []
        picture, received_ns = newest
        return [Frame(picture, t_ns - (time.monotonic_ns() - received_ns) - self._delay_ns)]

    def close(self) -> None:
        self._closing.set()
        self._thread.join()
        self._capture.release()

    def _read(self) -> None:
        while not self._closing.is_set():
            read, picture = self._capture.read()
            if read:
                self._newest = (_grey(np.asarray(picture, dtype=np.uint8)), time.monotonic_ns())
            else:
                self._closing.wait(UNPLUGGED_S)


def open_frames(source: str, delay_s: float = 0.0) -> FrameSource:
    """Open a camera ("0" or "/dev/video0"), a video or a folder; UserError if there is none."""
    if is_device(source):
        capture = cv2.VideoCapture(int(source) if source.isdigit() else source, cv2.CAP_V4L2)
        if not capture.isOpened():
            raise UserError(f"camera {source} cannot be opened: is it plugged in, and free?")
        return LiveFrames(capture, delay_s)
    path = Path(source)
    return RecordedFrames(pictures_of(path), _rate_hz(path))


def is_device(source: str) -> bool:
    """Whether a source is a camera, by number or device, and not a file."""
    return source.isdigit() or source.startswith("/dev/")


def pictures_of(path: Path) -> Iterator[Grey]:
    """The pictures of a folder, by name (of numbers by their size), or of a video."""
    if path.is_dir():
        names = sorted((file for file in path.iterdir() if _is_picture(file)), key=_by_number)
        if not names:
            raise UserError(f"{path}: no pictures here ({', '.join(PICTURES)})")
        return (read_picture(name) for name in names)
    return iter([read_picture(path)]) if _is_picture(path) else _video(path)


def read_picture(path: Path) -> Grey:
    """A picture as grey values; UserError if it is none."""
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) if path.is_file() else None
    if picture is None:
        raise UserError(f"{path}: {'not a picture' if path.is_file() else 'there is no such file'}")
    return np.asarray(picture, dtype=np.uint8)


def _video(path: Path) -> Iterator[Grey]:
    capture = _opened(path)
    while True:
        read, picture = capture.read()
        if not read:
            capture.release()
            return
        yield _grey(np.asarray(picture, dtype=np.uint8))


def _is_picture(path: Path) -> bool:
    return path.suffix.lower() in PICTURES


def _rate_hz(path: Path) -> float:
    if path.is_dir() or _is_picture(path):
        return USUAL_RATE_HZ
    capture = _opened(path)
    rate_hz = float(capture.get(cv2.CAP_PROP_FPS))
    capture.release()
    return rate_hz or USUAL_RATE_HZ


def _opened(path: Path) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(str(path)) if path.is_file() else None
    if capture is None or not capture.isOpened():
        raise UserError(f"{path}: {'not a video' if path.is_file() else 'there is no such video or folder'}")
    return capture


def _grey(picture: Grey) -> Grey:
    if picture.ndim == 2:
        return picture
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), dtype=np.uint8)


def _by_number(path: Path) -> list[tuple[int, str]]:
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", path.stem)]
