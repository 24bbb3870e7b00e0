"""A simulated camera: renders what an e-puck's camera would send of a scene, in the sensor's own format.

Needs numba (the `lab` extra), which is loaded when a camera is made and not before.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robot_agent.drivers.sim.rendering.conditions import Conditions, conditions
from robot_agent.drivers.sim.rendering.lens import Lens
from robot_agent.drivers.sim.rendering.scene import (
    FLOOR,
    LAMP_THETA_RAD,
    WALL,
    WALL_HEIGHT_M,
    Band,
    Post,
    Rectangle,
    Scene,
    SceneRobot,
    Surfaces,
    posts_along_walls,
    sorted_bands,
)
from robot_agent.drivers.sim.rendering.sensor import Sensor
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import PIXEL_FORMATS, Frame
from swarm.errors import UserError
from swarm.geometry import Pose

__all__ = ["Conditions", "SceneCamera", "SimulatedCamera", "calibration_frames", "conditions"]

DISTRACTOR_COLOURS = ("red", "orange", "brown", "blue", "green", "magenta", "yellow")


def _load_kernels() -> Any:
    try:
        from robot_agent.drivers.sim.rendering import kernels
    except ModuleNotFoundError as error:
        raise UserError(
            f"the simulated camera needs {error.name}: pip install 'swarm-runtime[lab]'"
        ) from error
    return kernels


class SimulatedCamera:
    """One robot's camera.

    Frames depend on nothing but the arguments and the generator: the same calls give the same bytes.
    """

    def __init__(
        self,
        model: CameraModel,
        conditions: Conditions,
        rng: np.random.Generator,
        pixel_format: str = "rgb565",
    ) -> None:
        if pixel_format not in PIXEL_FORMATS:
            raise UserError(f"pixel format {pixel_format!r}: use one of {', '.join(PIXEL_FORMATS)}")
        self.model = model
        self.conditions = conditions
        self._rng = rng
        self._pixel_format = pixel_format
        self._kernels = _load_kernels()
        self._lens = Lens(model, conditions.lens_blur_rad)
        self._surfaces = Surfaces(conditions.texture, rng)
        self._sensor = Sensor(model, conditions, rng)
        self._distractors: dict[Rectangle, tuple[Post, ...]] = {}

    def render(self, t_ns: int, own_pose: Pose, scene: Scene, turn_rate_rad_s: float = 0.0) -> Frame:
        """The frame of a robot that stands (and turns) at `own_pose`, in the arena frame."""
        camera = self.model.pose(own_pose)
        bands = sorted_bands(self._with_distractors(scene), camera, own_pose)
        self._paint_room(camera, scene)
        self._paint_bands(camera, bands)
        self._lens.blur(abs(turn_rate_rad_s) * self.conditions.exposure_s)
        skew = -turn_rate_rad_s * self.conditions.readout_s / self.model.height / self._lens.raster[1]
        data = self._sensor.develop(self._kernels, self._lens, skew, self._pixel_format)
        return Frame(t_ns, self.model.width, self.model.height, self._pixel_format, data)

    def _paint_room(self, camera: Pose, scene: Scene) -> None:
        rooms = np.array([[w.west_m, w.south_m, w.east_m, w.north_m] for w in scene.walls]).reshape(-1, 4)
        look = self._surfaces
        self._kernels.paint_room(
            self._lens.fine,
            self._lens.walls_m,
            self._view(camera),
            self._lens.raster,
            rooms,
            WALL_HEIGHT_M,
            WALL,
            FLOOR,
            look.floor,
            look.stains,
            look.panorama,
        )

    def _paint_bands(self, camera: Pose, bands: list[Band]) -> None:
        table = np.array([_band_row(band, camera, self.conditions.exposure_s) for band in bands])
        lamp_rad = LAMP_THETA_RAD - camera.theta_rad
        lamp = np.array([math.cos(lamp_rad), -math.sin(lamp_rad)])
        lens = self._lens
        self._kernels.paint_bands(
            lens.fine, lens.walls_m, self._view(camera), lens.raster, table.reshape(-1, 10), lamp
        )

    def _view(self, camera: Pose) -> NDArray[np.float64]:
        cos, sin = math.cos(camera.theta_rad), math.sin(camera.theta_rad)
        return np.array([camera.x_m, camera.y_m, cos, sin, self.model.height_m])

    def _with_distractors(self, scene: Scene) -> Scene:
        if not self.conditions.distractors or not scene.walls:
            return scene
        walls = scene.walls[0]
        room = Rectangle(walls.west_m, walls.south_m, walls.east_m, walls.north_m)
        if room not in self._distractors:
            number = self.conditions.distractors
            self._distractors[room] = posts_along_walls(room, number, DISTRACTOR_COLOURS, self._rng)
        return Scene(scene.walls, scene.bodies, scene.posts + self._distractors[room])


def _band_row(band: Band, camera: Pose, exposure_s: float) -> tuple[float, ...]:
    """A band in the camera's frame, as the kernel takes it."""
    place = camera.relative(Pose(band.x_m, band.y_m, 0.0))
    ahead_m, right_m = place.x_m, -place.y_m
    cos, sin = math.cos(camera.theta_rad), math.sin(camera.theta_rad)
    east_m_s, north_m_s = band.velocity_m_s
    ahead_m_s, right_m_s = cos * east_m_s + sin * north_m_s, sin * east_m_s - cos * north_m_s
    slope_moved = 0.0
    if ahead_m > band.radius_m:
        slope_moved = abs(right_m_s - right_m / ahead_m * ahead_m_s) / ahead_m * exposure_s
    shape = (ahead_m, right_m, band.radius_m, band.bottom_m, band.top_m)
    return (*shape, *band.colour, band.shine, slope_moved)


class SceneCamera:
    """A `Camera` that shows a simulated camera what `look` says of a moment: own pose, scene and turn rate.

    `look` gives None while the camera is to be stalled.
    """

    def __init__(
        self, camera: SimulatedCamera, look: Callable[[int], tuple[Pose, Scene, float] | None]
    ) -> None:
        self._camera = camera
        self._look = look

    def capture(self, t_ns: int) -> Frame | None:
        seen = self._look(t_ns)
        return None if seen is None else self._camera.render(t_ns, *seen)


def calibration_frames(camera: SimulatedCamera, skirt: str, ranges_m: tuple[float, ...]) -> list[Frame]:
    """What `robot-agent calibrate` sees: a robot straight ahead, at each range, in a white room."""
    own = Pose(0.0, 0.0, 0.0)
    ahead_m = camera.model.forward_m
    room = (Rectangle(-0.3, -0.6, 0.9, 0.6),)
    bodies = [SceneRobot(Pose(ahead_m + range_m, 0.0, 0.0), skirt) for range_m in ranges_m]
    return [camera.render(number, own, Scene(room, (body,))) for number, body in enumerate(bodies)]
