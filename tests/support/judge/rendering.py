"""Frames of a scene, and what is true in them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from swarm.geometry import Pose
from tests.support.judge import kernels
from tests.support.judge.optics import Camera, Points
from tests.support.judge.primitives import world
from tests.support.judge.scene import Appearance, Image, Scene
from tests.support.judge.sensor import Sensor

PATCH_ROWS, PATCH_COLUMNS = 12, 48  # patches of the skirt's near half; more change the fraction by < 1 %


@dataclass(frozen=True)
class Truth:
    """Where the robot's axis is and how much of its skirt shows.

    `bearing_rad` (left positive) and `distance_m` are seen from the camera, along the floor; `forward_m`
    and `left_m` from the observing robot's own middle. `visible_fraction` is the part of the skirt's
    outline in the picture and not behind another thing.
    """

    bearing_rad: float
    distance_m: float
    forward_m: float
    left_m: float
    visible_fraction: float


def render(
    scene: Scene, observer: Pose, camera: Camera, sensor: Sensor, generator: np.random.Generator
) -> bytes:
    """The frame that the camera on a robot at `observer` hands on: width x height x 2 bytes."""
    return sensor.read(camera.expose(traced(scene, observer, camera)), generator)


def traced(scene: Scene, observer: Pose, camera: Camera) -> Image:
    """Radiance (height, width, 3) before the lens's blur."""
    light = np.empty((camera.height, camera.width, 3), np.float32)
    numbers = np.empty((camera.height, camera.width), np.int64)
    view, arrays = _view(observer, camera), world(scene)
    kernels.draw_middles(camera.rays, view, arrays, light, numbers)
    kernels.draw_edges(camera.rays, view, arrays, light, numbers)
    return light


def _view(observer: Pose, camera: Camera) -> tuple[float, float, float, float, float]:
    """The camera as the kernels read it."""
    place = camera.pose(observer)
    return place.x_m, place.y_m, camera.height_m, math.cos(place.theta_rad), math.sin(place.theta_rad)


def truth(scene: Scene, observer: Pose, camera: Camera) -> Truth:
    """What a perfect observer would report of the frame."""
    seen, own = camera.pose(observer).relative(scene.robot), observer.relative(scene.robot)
    bearing_rad, distance_m = math.atan2(seen.y_m, seen.x_m), math.hypot(seen.x_m, seen.y_m)
    return Truth(bearing_rad, distance_m, own.x_m, own.y_m, visible_fraction(scene, observer, camera))


def visible_fraction(scene: Scene, observer: Pose, camera: Camera) -> float:
    """The part of the skirt's near half, by its size in the picture, that the frame shows."""
    patches = _near_half(scene.appearance, camera.pose(observer).relative(scene.robot), camera.height_m)
    pixels = camera.project(patches)
    inside = ((pixels >= 0) & (pixels < (camera.width, camera.height))).all(axis=1)
    shown: int = kernels.count_shown(patches[inside], _view(observer, camera), world(scene))
    return shown / len(patches)


def _near_half(look: Appearance, seen: Pose, camera_height_m: float) -> Points:
    """Points on the skirt, forward, left, up of the camera, evenly spread over its outline."""
    distance_m, radius_m = math.hypot(seen.x_m, seen.y_m), look.skirt_radius_m
    across = (np.arange(PATCH_COLUMNS) + 0.5) / PATCH_COLUMNS * 2 - 1
    # Tangents touch the cylinder where its normal leans this far from the line to the camera.
    normal_rad = np.arcsin(across * math.sqrt(1 - (radius_m / distance_m) ** 2))
    theta_rad = math.atan2(seen.y_m, seen.x_m) + math.pi + normal_rad
    up_m = np.linspace(look.skirt_bottom_m, look.skirt_top_m, 2 * PATCH_ROWS + 1)[1::2] - camera_height_m
    x, y = seen.x_m + radius_m * np.cos(theta_rad), seen.y_m + radius_m * np.sin(theta_rad)
    rows, columns = np.mgrid[0:PATCH_ROWS, 0:PATCH_COLUMNS]
    return np.stack([x[columns], y[columns], up_m[rows]], axis=-1).reshape(-1, 3)
