"""The backend: several cameras, tags that do not sit on the axis, and its settings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import Setup, TrackedPose
from tracker_bridge.backends.overhead import HAND_OVER_NS, SYSTEM, Camera, OverheadTracker
from tracker_bridge.emulators.camera.floor import plain_floor
from tracker_bridge.emulators.camera.optics import Optics, Station
from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.emulators.camera.scene import Faults, Swarm, TagPlate
from tracker_bridge.emulators.camera.true_view import true_view
from tracker_bridge.overhead.frames import RecordedFrames
from tracker_bridge.overhead.settings import RobotTag
from tracker_bridge.overhead.tag_tracking import TagTracker
from tracker_bridge.overhead.tags import TagDetector, TagFamily

Grey = npt.NDArray[np.uint8]

FAMILY = TagFamily("36h11", [0, 1])
TAGS = {0: RobotTag(0, "a"), 1: RobotTag(1, "b")}
SMALL = Optics(480, 480, centre_u=240.0, centre_v=240.0)
SECOND_NS = 1_000_000_000


def renderer(x_m: float) -> CameraRenderer:
    """A camera over (x, 1) m that sees 1.2 m of the floor."""
    rng = np.random.default_rng(1)
    codes = {tag: FAMILY.code(tag) for tag in FAMILY.ids}
    station = Station(x_m, 1.0)
    return CameraRenderer(SMALL, station, TagPlate(), Faults(), codes, plain_floor(SMALL, rng), rng)


def over(x_m: float, swarms: list[Swarm]) -> Camera:
    camera = renderer(x_m)
    pictures = [camera.render(swarm) for swarm in swarms]
    return Camera(RecordedFrames(pictures, 10.0), true_view(camera), TagTracker(TagDetector(FAMILY)))


def standing(**poses: tuple[float, float, float]) -> Swarm:
    ids = tuple(tag for tag, worn in TAGS.items() if worn.robot in poses)
    places = np.array([poses[TAGS[tag].robot] for tag in ids]).reshape(-1, 3)
    return Swarm(ids, places, np.zeros_like(places))


def followed(tracker: OverheadTracker, frames: int) -> list[list[TrackedPose]]:
    return [tracker.poses(SECOND_NS + number * SECOND_NS // 10) for number in range(frames)]


def test_a_robot_is_handed_over_between_two_cameras_without_a_jump() -> None:
    path = [standing(a=(0.8 + 0.02 * number, 1.0, 0.3)) for number in range(40)]
    tracker = OverheadTracker([over(0.7, path), over(1.6, path)], TAGS, 0.06, 0.12)
    given = followed(tracker, len(path))
    assert [len(poses) for poses in given[:15]] == [1] * 15, "told by one camera at a time"
    silent = sum(not poses for poses in given)
    assert silent <= HAND_OVER_NS // (SECOND_NS // 10)
    for number, poses in enumerate(given):
        for tracked in poses:
            assert tracked.pose.x_m == pytest.approx(0.8 + 0.02 * number, abs=0.003)
            assert tracked.quality > 0.9
            assert tracked.received_t_ns >= tracked.captured_t_ns


def test_a_tag_beside_the_axis_tells_where_the_axis_is() -> None:
    axis = Pose(1.0, 1.0, 0.5)
    worn = RobotTag(0, "a", ahead_m=0.02, left_m=-0.01, turn_rad=math.pi / 2)
    on_plate = axis.compose(Pose(worn.ahead_m, worn.left_m, worn.turn_rad))
    camera = over(1.0, [standing(a=(on_plate.x_m, on_plate.y_m, on_plate.theta_rad))])
    ((tracked,),) = followed(OverheadTracker([camera], {0: worn}, 0.06, 0.12), 1)
    assert tracked.pose.distance_m(axis) < 0.002
    assert tracked.pose.theta_rad == pytest.approx(axis.theta_rad, abs=0.02)


def test_a_tag_of_another_size_is_refused() -> None:
    camera = over(1.0, [standing(a=(1.0, 1.0, 0.0))])
    assert followed(OverheadTracker([camera], TAGS, 0.10, 0.12), 1) == [[]]


def opened(file: str) -> object:
    setup = Setup(tracked_experiment(TrackerSettings(backend="overhead", file=file)), None)
    with SYSTEM.open(setup) as backend:
        return backend


def test_settings_that_lack_something_are_refused_with_the_cure(tmp_path: Path) -> None:
    settings = tmp_path / "overhead.toml"
    with pytest.raises(UserError, match="no file says what tags and cameras"):
        opened("")
    settings.write_text('[[tag]]\nid = 3\nrobot = "a"\n\n[[tag]]\nid = 3\nrobot = "b"\n')
    with pytest.raises(UserError, match=r"overhead\.toml:6: two robots wear the tag 3"):
        opened(str(settings))
    settings.write_text('[[tag]]\nid = 3\nrobot = "a"\n')
    with pytest.raises(UserError, match=r"no \[\[camera\]\]"):
        opened(str(settings))
    settings.write_text(
        '[[tag]]\nid = 3\nrobot = "a"\n[[camera]]\nsource = "v.avi"\ncalibration = "c.toml"\n'
    )
    with pytest.raises(UserError, match=r"c\.toml: there is no such file"):
        opened(str(settings))
    lens = "width = 4\nheight = 3\nfocal_u_px = 1.0\nfocal_v_px = 1.0\ncentre_u_px = 1.0\ncentre_v_px = 1.0\n"
    (tmp_path / "c.toml").write_text(f"[lens]\n{lens}")
    with pytest.raises(UserError, match="the camera's place is missing"):
        opened(str(settings))
