"""Where pictures come from."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from swarm.errors import UserError
from tracker_bridge.overhead.frames import RecordedFrames, open_frames, pictures_of, read_picture

SECOND_NS = 1_000_000_000


def grey(level: int) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    return np.full((48, 64), level, dtype=np.uint8)


def test_pictures_come_when_they_are_due_and_once() -> None:
    source = RecordedFrames([grey(level) for level in (10, 20, 30)], rate_hz=10.0)
    taken = [(frame.picture[0, 0], frame.captured_t_ns) for frame in source.frames(5 * SECOND_NS)]
    assert taken == [(10, 5 * SECOND_NS)]
    assert source.frames(5 * SECOND_NS + SECOND_NS // 20) == []
    later = source.frames(6 * SECOND_NS)
    assert [frame.captured_t_ns for frame in later] == [5_100_000_000, 5_200_000_000]
    assert source.frames(9 * SECOND_NS) == []


def test_a_folder_is_read_in_the_order_of_its_numbers(tmp_path: Path) -> None:
    for number in (10, 9, 100):
        cv2.imwrite(str(tmp_path / f"frame{number}.png"), grey(number))
    (tmp_path / "notes.txt").write_text("no picture")
    assert [int(picture[0, 0]) for picture in pictures_of(tmp_path)] == [9, 10, 100]


def test_a_video_keeps_its_own_rate(tmp_path: Path) -> None:
    path = tmp_path / "video.avi"
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20.0, (64, 48), isColor=False)
    for level in (40, 80, 120):
        video.write(grey(level))
    video.release()
    source = open_frames(str(path))
    source.frames(0)
    (second,) = source.frames(SECOND_NS // 20)
    assert second.captured_t_ns == SECOND_NS // 20
    assert int(second.picture.mean()) == pytest.approx(80, abs=3)
    source.close()


@pytest.mark.parametrize("name", ["missing.avi", "empty", "text.png"])
def test_what_is_no_picture_is_refused_by_name(name: str, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(UserError, match=name.replace(".", r"\.")):
        open_frames(str(tmp_path / name))
    if name == "text.png":
        with pytest.raises(UserError, match="not a picture"):
            read_picture(tmp_path / name)


def test_a_camera_that_is_not_there_is_refused() -> None:
    with pytest.raises(UserError, match="/dev/video99 cannot be opened: is it plugged in"):
        open_frames("/dev/video99")
