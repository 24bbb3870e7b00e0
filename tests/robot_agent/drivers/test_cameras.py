"""Cameras of real robots: on the link, stored pictures in their place, and one that hangs."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from robot_agent.drivers.cameras.choice import camera_named
from robot_agent.drivers.cameras.fitted import SAME_BEFORE_FROZEN, FittedCamera, rgb565_frame
from robot_agent.drivers.cameras.stored import video_frames
from robot_agent.drivers.cameras.v4l2 import frame_of
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import frame_pixels
from swarm.errors import UserError
from tests.support.emulated_robot import EmulatedRig

MODEL = CameraModel(160, 120, math.radians(45.0))
SECOND_NS = 1_000_000_000


def picture(red: int, width: int = 160, height: int = 120) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """A red square in the middle of grey."""
    pixels = np.full((height, width, 3), 100, dtype=np.uint8)
    pixels[height // 4 : 3 * height // 4, width // 4 : 3 * width // 4] = (red, 0, 0)
    return pixels


def say_nothing(*_event: str) -> None:
    pass


def test_a_folders_pictures_come_in_order_at_the_calibrations_size(tmp_path: Path) -> None:
    for number, red in enumerate((80, 160, 240)):
        bgr = cv2.cvtColor(picture(red, 640, 480), cv2.COLOR_RGB2BGR)
        cv2.imwrite(str(tmp_path / f"{number}.png"), bgr)
    camera = camera_named(str(tmp_path), None, MODEL, 1.0, say_nothing)
    reds = []
    while frame := camera.capture(5 * SECOND_NS):
        assert (frame.width, frame.height, frame.pixel_format) == (160, 120, "rgb565")
        assert 4.9 < frame.t_ns / SECOND_NS <= 5.0
        reds.append(int(frame_pixels(frame)[60, 80, 0]))
    assert reds == pytest.approx([80, 160, 240], abs=5)


def test_a_video_keeps_its_own_pace(tmp_path: Path) -> None:
    file = tmp_path / "robot.avi"
    writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (160, 120))
    for red in range(0, 250, 10):
        writer.write(cv2.cvtColor(picture(red), cv2.COLOR_RGB2BGR))
    writer.release()
    now_ns = [SECOND_NS]
    take = video_frames(file, lambda: now_ns[0])
    first = take()
    now_ns[0] += SECOND_NS
    later = take()
    assert first is not None
    assert later is not None
    assert frame_pixels(first)[60, 80, 0] < 20
    assert frame_pixels(later)[60, 80, 0] == pytest.approx(100, abs=12), "ten frames later"


def test_a_camera_that_hangs_is_noticed() -> None:
    said: list[str] = []
    frame = rgb565_frame(picture(200), 0)
    camera = FittedCamera(lambda: frame, MODEL, 1.0, lambda _, text: said.append(text), lambda: 0)
    frames = [camera.capture(number) for number in range(10)]
    assert [frame is not None for frame in frames] == [True] * SAME_BEFORE_FROZEN + [False] * 5
    assert len(said) == 1
    assert "same picture" in said[0]


def test_a_frames_time_is_that_of_its_exposure_in_the_runs_time() -> None:
    frame = rgb565_frame(picture(200), 3 * SECOND_NS)
    camera = FittedCamera(lambda: frame, MODEL, 4.0, say_nothing, lambda: 3 * SECOND_NS + 50_000_000)
    captured = camera.capture(60 * SECOND_NS)
    assert captured is not None
    assert captured.t_ns == 60 * SECOND_NS - 200_000_000


def test_uyvy_becomes_yuyv() -> None:
    uyvy = bytes((1, 2, 3, 4)) * 16
    assert frame_of(uyvy, 2, 16, "UYVY", 0) == Frame(0, 2, 16, "yuyv", bytes((2, 1, 4, 3)) * 16)


@pytest.mark.parametrize(("name", "says"), [("", "this link has no camera"), ("nothing.avi", "as a video")])
def test_a_camera_that_is_not_there_is_an_error(name: str, says: str) -> None:
    with pytest.raises(UserError, match=says):
        camera_named(name, None, MODEL, 1.0, say_nothing)


@pytest.mark.parametrize(("link", "size"), [("serial", (40, 40)), ("wifi", (160, 120))])
def test_images_come_over_the_link_while_the_robot_stands(
    link: str, size: tuple[int, int], tmp_path: Path
) -> None:
    rig = EmulatedRig(link, "epuck2", tmp_path)
    frame, t_ns = None, rig.clock.t_ns
    while frame is None:
        t_ns += SECOND_NS // 10
        rig.run_to(t_ns)
        rig.body.wheel_steps(t_ns)
        frame = rig.body.take_picture()
    rig.close()
    assert (frame.width, frame.height) == size
    assert frame.data[:4] == bytes((0, 0, 0, 1)), "the ramp that the emulator shows, high byte first"
