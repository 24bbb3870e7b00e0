"""Tags followed through rendered videos: how many, how exactly, and after a loss."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from swarm.geometry import wrap_angle_rad
from tests.support.overhead_scene import Conditions, OverheadScene
from tracker_bridge.emulators.camera.optics import Optics
from tracker_bridge.overhead.arena_view import PlanePose
from tracker_bridge.overhead.tag_tracking import NEAR_FRAMES, STRIPS, TagTracker
from tracker_bridge.overhead.tags import TagDetector, TagFamily

Grey = npt.NDArray[np.uint8]

USUAL = Conditions()


def track(scene: OverheadScene, pictures: list[Grey]) -> list[dict[int, PlanePose]]:
    """The poses by tag in each picture."""
    tracker = TagTracker(TagDetector(TagFamily("36h11", range(scene.conditions.robots))))
    plate, view, found = scene.conditions.plate, scene.true_view(), []
    for picture in pictures:
        tags = tracker.track(picture)
        quads = np.array([tag.corners for tag in tags]).reshape(-1, 4, 2)
        poses = view.level_poses(quads, plate.height_m, plate.side_m) if tags else []
        found.append({tag.id: pose for tag, pose in zip(tags, poses, strict=True)})
    return found


def test_twenty_robots_are_found_exactly_and_none_that_is_not_there() -> None:
    scene = OverheadScene(USUAL, TagFamily("36h11"), 5)
    frames = list(scene.frames(20))
    found = track(scene, [picture for picture, _ in frames])
    seen = [
        (pose, truth[tag])
        for poses, (_, truth) in zip(found, frames, strict=True)
        for tag, pose in poses.items()
    ]
    errors_m = [math.hypot(pose.x_m - truth[0], pose.y_m - truth[1]) for pose, truth in seen]
    errors_rad = [abs(wrap_angle_rad(pose.theta_rad - truth[2])) for pose, truth in seen]
    assert len(seen) >= 0.995 * 20 * len(frames)
    assert np.percentile(errors_m, 99) <= 0.003
    assert np.percentile(errors_rad, 99) <= math.radians(1)
    assert max(errors_m) < 0.01, "no tag is taken for another"


@pytest.fixture(name="small")
def _small() -> OverheadScene:
    """Three robots below half a picture, for what does not depend on size."""
    optics = Optics(960, 1080, centre_u=480.0)
    return OverheadScene(replace(USUAL, robots=3, is_littered=False), TagFamily("36h11"), 6, optics)


def test_a_tag_that_was_hidden_is_found_again_where_it_was(small: OverheadScene) -> None:
    pictures = [picture for picture, _ in small.frames(4)]
    hidden = [*pictures[:2], _without(pictures[2], 1), *pictures[3:]]
    assert [sorted(poses) for poses in track(small, hidden)] == [[0, 1, 2], [0, 1, 2], [0, 2], [0, 1, 2]]


def test_a_robot_that_was_carried_away_is_found_where_it_is(small: OverheadScene) -> None:
    (before, _), *_ = small.frames(1)
    (after, truth), *_ = small.frames(1)  # another spread of the same robots
    found = track(small, [before] + [after] * (NEAR_FRAMES + STRIPS + 1))
    assert sorted(found[-1]) == [0, 1, 2]
    for tag, pose in found[-1].items():
        assert math.hypot(pose.x_m - truth[tag, 0], pose.y_m - truth[tag, 1]) < 0.003


def test_a_robot_that_never_comes_keeps_nobody_waiting(small: OverheadScene) -> None:
    tracker = TagTracker(TagDetector(TagFamily("36h11", [0, 1, 2, 99])))
    assert [[tag.id for tag in tracker.track(picture)] for picture, _ in small.frames(6)] == [[0, 1, 2]] * 6


def test_an_empty_picture_has_no_tags() -> None:
    tracker = TagTracker(TagDetector(TagFamily("36h11", [0])))
    assert tracker.track(np.full((120, 160), 128, dtype=np.uint8)) == []


def _without(picture: Grey, tag: int) -> Grey:
    """The picture with a hand over a tag."""
    (found,) = TagDetector(TagFamily("36h11", [tag])).find(picture)
    (left, top), (right, bottom) = found.corners.min(0).astype(int) - 8, found.corners.max(0).astype(int) + 8
    covered = picture.copy()
    covered[top:bottom, left:right] = 90
    return covered
