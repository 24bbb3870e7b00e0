"""A camera's frame rate and exposure, as the pre-flight judges them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import numpy as np
import pytest

from robot_agent.commands.camera_check import camera_findings
from robot_agent.commands.preflight import Finding
from robot_agent.drivers.cameras.fitted import rgb565_frame
from robot_agent.vision.frames import Frame


def looked_at(level: int, every: int) -> dict[str, Finding]:
    """The findings on a camera that shows one level in one of so many looks, ten a second."""
    t_s = 0.0

    def ticks() -> Iterator[int]:
        nonlocal t_s
        for number in count():
            t_s += 0.1
            yield number

    def take() -> Frame | None:
        frame = rgb565_frame(np.full((24, 32, 3), level, np.uint8), 0)
        return frame if every and round(10 * t_s) % every == 0 else None

    return {finding.check: finding for finding in camera_findings(take, ticks(), lambda: t_s)}


@pytest.mark.parametrize(
    ("level", "every", "camera", "exposure"),
    [
        (128, 2, "good", "good"),
        (128, 10, "doubtful", "good"),
        (10, 2, "good", "doubtful"),
        (255, 2, "good", "doubtful"),
    ],
)
def test_rate_and_exposure_are_judged(level: int, every: int, camera: str, exposure: str) -> None:
    found = looked_at(level, every)
    assert (found["camera"].verdict.value, found["exposure"].verdict.value) == (camera, exposure)
    assert all(finding.cure or finding.verdict.value == "good" for finding in found.values())


def test_a_camera_without_frames_is_bad() -> None:
    found = looked_at(128, 0)
    assert found["camera"].verdict.value == "bad"
    assert "exposure" not in found
