"""Pictures in a folder, or a video, in the place of a camera."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2

from robot_agent.drivers.cameras.fitted import TakeFrame, rgb565_frame
from robot_agent.vision.frames import Frame
from swarm.errors import UserError

PICTURES = (".png", ".jpg", ".jpeg")
DEFAULT_FRAMES_PER_S = 5.0
"""For videos that do not tell their pace: the paper's."""


def folder_frames(folder: Path, monotonic_ns: Callable[[], int] = time.monotonic_ns) -> TakeFrame:
    """The pictures of a folder in order of their names, one a call. UserError if there are none."""
    paths = sorted(path for path in folder.glob("*") if path.suffix.lower() in PICTURES)
    if not paths:
        raise UserError(f"{folder}: no pictures ({', '.join(PICTURES)})")
    waiting = iter(paths)

    def take() -> Frame | None:
        path = next(waiting, None)
        return rgb565_frame(_read(path), monotonic_ns()) if path else None

    return take


def _read(path: Path) -> cv2.typing.MatLike:
    picture = cv2.imread(str(path))
    if picture is None:
        raise UserError(f"{path}: cannot be read as a picture")
    return cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)


def video_frames(file: Path, monotonic_ns: Callable[[], int] = time.monotonic_ns) -> TakeFrame:
    """A video's frames at its own pace from the first call on; those that come too fast are passed over.

    UserError if it cannot be read.
    """
    video = cv2.VideoCapture(str(file))
    if not video.isOpened():
        raise UserError(f"{file}: cannot be read as a video")
    period_ns = 1e9 / (video.get(cv2.CAP_PROP_FPS) or DEFAULT_FRAMES_PER_S)
    frames = enumerate(_pictures(video))
    began_ns: list[int] = []

    def take() -> Frame | None:
        now_ns = monotonic_ns()
        began_ns[:] = began_ns or [now_ns]
        due = int((now_ns - began_ns[0]) / period_ns)
        for number, picture in frames:
            if number >= due:
                return rgb565_frame(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), now_ns)
        return None

    return take


def _pictures(video: cv2.VideoCapture) -> Iterator[cv2.typing.MatLike]:
    while True:
        good, picture = video.read()
        if not good:
            return
        yield picture
