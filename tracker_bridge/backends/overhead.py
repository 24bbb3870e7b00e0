"""Cameras above the arena that see a printed tag on every robot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from swarm.clock import NS_PER_S
from swarm.errors import UserError
from swarm.geometry import Pose
from tracker_bridge.backends.interface import Backend, Setup, TrackedPose, TrackingSystem
from tracker_bridge.overhead.arena_view import ArenaView, PlanePose
from tracker_bridge.overhead.frames import Frame, FrameSource, is_device, open_frames
from tracker_bridge.overhead.settings import Calibration, CameraSettings, RobotTag, load_settings
from tracker_bridge.overhead.tag_tracking import TagTracker
from tracker_bridge.overhead.tags import Tag, TagDetector, TagFamily

HAND_OVER_NS = NS_PER_S // 5
"""A robot in two views is told by one camera until that has not seen it for so long: two cameras disagree by
millimetres, and a robot would jump to and fro."""
LARGEST_RESIDUAL = 0.12
"""Of a tag's side: corners that miss a square of the right size by more are not this tag, or it leans."""


@dataclass
class Camera:
    """One camera: its pictures, its place, and the tags that it follows."""

    source: FrameSource
    view: ArenaView
    tracker: TagTracker


@dataclass
class OverheadTracker:
    """Robots by their tags, from one or several cameras."""

    cameras: list[Camera]
    tags: dict[int, RobotTag]
    side_m: float
    height_m: float
    _told_by: dict[str, tuple[int, int]] = field(default_factory=dict)
    """For each robot, the camera that last told its pose and when."""

    def poses(self, t_ns: int) -> list[TrackedPose]:
        seen = [
            (frame.captured_t_ns, number, tracked)
            for number, camera in enumerate(self.cameras)
            for frame in camera.source.frames(t_ns)
            for tracked in self._seen(camera, frame, t_ns)
        ]
        seen.sort(key=lambda each: each[:2])
        return [tracked for _, number, tracked in seen if self._tells(number, tracked)]

    def close(self) -> None:
        """Let go of the cameras."""
        for camera in self.cameras:
            camera.source.close()

    def _seen(self, camera: Camera, frame: Frame, t_ns: int) -> list[TrackedPose]:
        tags = camera.tracker.track(frame.picture)
        if not tags:
            return []
        quads = np.array([tag.corners for tag in tags])
        places = camera.view.level_poses(quads, self.height_m, self.side_m)
        return [
            self._tracked(tag, place, frame.captured_t_ns, t_ns)
            for tag, place in zip(tags, places, strict=True)
            if place.residual_m < LARGEST_RESIDUAL * self.side_m
        ]

    def _tracked(self, tag: Tag, place: PlanePose, captured_t_ns: int, t_ns: int) -> TrackedPose:
        worn = self.tags[tag.id]
        return TrackedPose(
            worn.robot,
            _robot_pose(place, worn),
            captured_t_ns,
            received_t_ns=t_ns,
            residual_m=place.residual_m,
            quality=tag.agreement,
            height_m=self.height_m,
        )

    def _tells(self, camera: int, tracked: TrackedPose) -> bool:
        teller, last_ns = self._told_by.get(tracked.robot, (camera, -1))
        late = tracked.captured_t_ns <= last_ns
        if late or (teller != camera and tracked.captured_t_ns - last_ns < HAND_OVER_NS):
            return False
        self._told_by[tracked.robot] = (camera, tracked.captured_t_ns)
        return True


def _robot_pose(place: PlanePose, tag: RobotTag) -> Pose:
    """The robot's pose: its tag's, without where the tag sits on the robot."""
    mounted = Pose(tag.ahead_m, tag.left_m, tag.turn_rad)
    on_tag = mounted.relative(Pose(0.0, 0.0, 0.0))
    return Pose(place.x_m, place.y_m, place.theta_rad).compose(on_tag)


@contextmanager
def _opened(setup: Setup) -> Iterator[Backend]:
    file = setup.experiment.tracker.file
    if not file:
        raise UserError('[tracker] backend is "overhead", but no file says what tags and cameras there are')
    with closing(_made(Path(file))) as tracker:
        yield tracker


def _made(path: Path) -> OverheadTracker:
    settings = load_settings(path)
    if not settings.camera:
        raise UserError(f"{path}: no [[camera]] is given")
    family = TagFamily(settings.family, [tag.id for tag in settings.tag])
    cameras = [_camera(path, camera, family) for camera in settings.camera]
    return OverheadTracker(cameras, {tag.id: tag for tag in settings.tag}, settings.side_m, settings.height_m)


def _camera(path: Path, settings: CameraSettings, family: TagFamily) -> Camera:
    calibration = path.parent / settings.calibration
    view = Calibration.load(calibration).arena_view()
    if view is None:
        raise UserError(
            f"{calibration}: the camera's place is missing; run `tracker-bridge calibrate camera`"
        )
    source = settings.source if is_device(settings.source) else str(path.parent / settings.source)
    return Camera(open_frames(source, settings.delay_s), view, TagTracker(TagDetector(family)))


SYSTEM = TrackingSystem(_opened)
