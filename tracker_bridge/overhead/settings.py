"""The files of an overhead camera: what a laboratory's tags and cameras are, and what calibration found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np

from swarm.config.toml_files import Between, ConfigFile
from tracker_bridge.overhead.arena_view import ArenaView
from tracker_bridge.overhead.lens import Lens


@dataclass(frozen=True)
class RobotTag:
    """[[tag]]: the tag on a robot. Its top edge points ahead, but for `turn_rad`."""

    id: Annotated[int, Between(0, 100_000)]
    robot: str
    ahead_m: Annotated[float, Between(-1, 1)] = 0.0
    """The tag's middle, from the robot's axis."""
    left_m: Annotated[float, Between(-1, 1)] = 0.0
    turn_rad: Annotated[float, Between(-7, 7)] = 0.0
    """From the robot's heading to the tag's, counter-clockwise."""


@dataclass(frozen=True)
class FloorTag:
    """[[floor]]: a tag that lies at a known place, for calibration."""

    id: Annotated[int, Between(0, 100_000)]
    x_m: float
    y_m: float
    theta_rad: float = 0.0
    """Where its top edge points."""
    height_m: Annotated[float, Between(0, 10)] = 0.0


@dataclass(frozen=True)
class CameraSettings:
    """[[camera]]: one of the cameras."""

    source: str
    """Its number or device; or a video or a folder of pictures, from the place of this file."""
    calibration: str
    """The file that `tracker-bridge calibrate camera` wrote, from the place of this file."""
    delay_s: Annotated[float, Between(0, 1)] = 0.0
    """From exposure to receipt."""


@dataclass(frozen=True)
class OverheadSettings:
    """The file that [tracker] names."""

    tag: tuple[RobotTag, ...]
    camera: tuple[CameraSettings, ...] = ()
    floor: tuple[FloorTag, ...] = ()
    family: str = "36h11"
    side_m: Annotated[float, Between(0.005, 1)] = 0.06
    """The black square of a robot's tag."""
    floor_side_m: Annotated[float, Between(0.005, 1)] = 0.1
    height_m: Annotated[float, Between(0, 5)] = 0.12
    """Of the robots' tags above the floor."""


def load_settings(path: Path) -> OverheadSettings:
    """UserError, with the line, for a file that does not say what tags and cameras there are."""
    file = ConfigFile(path)
    settings = file.settings(OverheadSettings)
    for number, tag in enumerate(settings.tag):
        if tag.id in [other.id for other in settings.tag[:number]]:
            raise file.error(("tag", number, "id"), f"two robots wear the tag {tag.id}")
    return settings


@dataclass(frozen=True)
class ViewSettings:
    """[view]: the turn (a rotation vector) and the shift from the arena's frame to the camera's."""

    turn_rad: tuple[float, float, float]
    shift_m: tuple[float, float, float]
    residual_px: float = 0.0


@dataclass(frozen=True)
class Calibration:
    """The file that calibration writes, first with the lens alone."""

    lens: Lens
    view: ViewSettings | None = None

    @classmethod
    def load(cls, path: Path) -> Calibration:
        """UserError, with the line, for a file that is not one."""
        return ConfigFile(path).settings(cls)

    @classmethod
    def of_view(cls, view: ArenaView) -> Calibration:
        turn = cv2.Rodrigues(view.rotation)[0].ravel()
        return cls(view.lens, ViewSettings(_three(turn), _three(view.shift_m), view.residual_px))

    def arena_view(self) -> ArenaView | None:
        if self.view is None:
            return None
        rotation = np.asarray(cv2.Rodrigues(np.array(self.view.turn_rad))[0], dtype=np.float64)
        return ArenaView(self.lens, rotation, np.array(self.view.shift_m), self.view.residual_px)

    def as_toml(self) -> str:
        """What `load` reads."""
        tables = {"lens": self.lens, **({} if self.view is None else {"view": self.view})}
        return "\n".join(f"[{name}]\n{_table(vars(values))}" for name, values in tables.items())


def _three(values: np.ndarray) -> tuple[float, float, float]:
    first, second, third = (float(value) for value in values)
    return first, second, third


def _table(values: dict[str, object]) -> str:
    return "".join(f"{name} = {_value(value)}\n" for name, value in values.items())


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(repr(float(part)) for part in value)}]"
    return repr(value)
