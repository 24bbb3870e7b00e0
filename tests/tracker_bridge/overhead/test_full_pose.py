"""The whole pose of one tag, on photographs of a turntable."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tracker_bridge.overhead.frames import read_picture
from tracker_bridge.overhead.full_pose import TagPose, TagPoses, tag_poses
from tracker_bridge.overhead.lens import Lens
from tracker_bridge.overhead.tags import TagDetector, TagFamily

TAGS = Path(__file__).parents[2] / "data" / "tags"
LENS = Lens(1056, 792, 329.8729619143081, 332.94611303946357, 528.0, 396.0)
SIDE_M = 0.065


def poses_at(angle: int) -> TagPoses:
    (tag,) = TagDetector(TagFamily("36h11", [76])).find(
        read_picture(TAGS / f"test_image_rotation_{angle}.png")
    )
    return tag_poses(tag.corners, LENS, SIDE_M)


def turned_deg(pose: TagPose) -> float:
    """From facing the camera, about the vertical: of the direction out of the print."""
    return math.degrees(math.atan2(pose.rotation[0, 2], -pose.rotation[2, 2]))


def test_the_turntable_turned_by_as_much_as_it_says() -> None:
    turned = {angle: turned_deg(poses_at(angle).best) for angle in (-40, 0, 40)}
    assert turned[40] - turned[0] == pytest.approx(40, abs=3)
    assert turned[0] - turned[-40] == pytest.approx(40, abs=3)
    assert turned[40] - turned[-40] == pytest.approx(80, abs=3)


def test_only_head_on_is_the_pose_said_to_have_two_solutions() -> None:
    assert poses_at(0).is_ambiguous
    assert not poses_at(-40).is_ambiguous
    assert not poses_at(40).is_ambiguous
