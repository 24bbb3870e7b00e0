"""The camera that a real robot's settings name."""

from __future__ import annotations

from pathlib import Path

from robot_agent.drivers.cameras.fitted import FittedCamera, TakeFrame
from robot_agent.drivers.cameras.stored import folder_frames, video_frames
from robot_agent.drivers.cameras.v4l2 import v4l2_frames
from robot_agent.drivers.notices import Say
from robot_agent.vision.camera_model import CameraModel
from swarm.errors import UserError


def camera_named(
    name: str, on_link: TakeFrame | None, model: CameraModel, speed: float, say: Say
) -> FittedCamera:
    """`name` is empty for the camera on the robot's own link, /dev/videoN, a folder of pictures or a video.

    UserError if there is none.
    """
    return FittedCamera(_source(name, on_link), model, speed, say)


def _source(name: str, on_link: TakeFrame | None) -> TakeFrame:
    if name.startswith("/dev/"):
        return v4l2_frames(name)
    if name:
        return folder_frames(Path(name)) if Path(name).is_dir() else video_frames(Path(name))
    if on_link is None:
        raise UserError('this link has no camera: name one (camera = "/dev/video0") in the robot\'s table')
    return on_link
