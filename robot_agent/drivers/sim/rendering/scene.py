"""What stands in front of a simulated camera: walls, robots and posts, and what they look like."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.drivers.sim.rendering.colours import COLOURS, Colour, colour
from robot_agent.vision.demonstrator import SKIRT_BOTTOM_M, SKIRT_RADIUS_M, SKIRT_TOP_M
from swarm.geometry import Pose


class Walled(Protocol):
    """Anything with four straight walls: a Rectangle here, or a swarm.geometry.Compartment."""

    @property
    def west_m(self) -> float: ...
    @property
    def south_m(self) -> float: ...
    @property
    def east_m(self) -> float: ...
    @property
    def north_m(self) -> float: ...


@dataclass(frozen=True)
class Rectangle:
    """The walls of a room, in metres in the arena frame."""

    west_m: float
    south_m: float
    east_m: float
    north_m: float


@dataclass(frozen=True)
class SceneRobot:
    """A robot: where it is, its skirt's colour and (for motion blur) its velocity, in the arena frame."""

    pose: Pose
    skirt: str
    velocity_m_s: tuple[float, float] = (0.0, 0.0)
    hat: str = ""
    """The colour of a hat that lies on the skirt; without, a grey one shows the boards below it."""


@dataclass(frozen=True)
class Post:
    """A coloured cylinder that stands on the floor."""

    x_m: float
    y_m: float
    colour: str
    radius_m: float = 0.02
    height_m: float = 0.08


@dataclass(frozen=True)
class Scene:
    """All that a camera could see.

    A wall is seen from the inside of its rectangle only: an observer that stands just outside a
    corner looks in as if the corner were open there.
    """

    walls: tuple[Walled, ...]
    bodies: tuple[SceneRobot, ...] = ()
    posts: tuple[Post, ...] = ()


@dataclass(frozen=True)
class Band:
    """A part of an upright cylinder that has one colour."""

    x_m: float
    y_m: float
    radius_m: float
    bottom_m: float
    top_m: float
    colour: Colour
    shine: float = 0.0
    velocity_m_s: tuple[float, float] = (0.0, 0.0)


def body_bands(body: SceneRobot) -> list[Band]:
    """A robot in the order of painting: wheels in the shadow, board, the skirt around it, tracking hat."""
    parts = [
        (0.030, 0.0, SKIRT_BOTTOM_M, COLOURS["black"], 0.0),
        (0.032, 0.035, 0.056, (0.05, 0.12, 0.06), 0.0),
        (SKIRT_RADIUS_M, SKIRT_BOTTOM_M, SKIRT_TOP_M, colour(body.skirt), 0.06),
        (0.034, 0.052, 0.058, (0.16, 0.16, 0.17), 0.03),
    ]
    if body.hat:
        parts[3] = (SKIRT_RADIUS_M, SKIRT_TOP_M, 0.058, colour(body.hat), 0.03)
    x_m, y_m = body.pose.x_m, body.pose.y_m
    return [
        Band(x_m, y_m, radius_m, bottom_m, top_m, paint, shine, body.velocity_m_s)
        for radius_m, bottom_m, top_m, paint, shine in parts
    ]


def post_band(post: Post) -> Band:
    return Band(post.x_m, post.y_m, post.radius_m, 0.0, post.height_m, colour(post.colour), 0.03)


def posts_along_walls(
    walls: Walled, number: int, colours: Iterable[str], rng: np.random.Generator
) -> tuple[Post, ...]:
    """Distractors: posts of random size and colour that stand close to the walls, out of a robot's way."""
    names = tuple(colours)
    return tuple(_post_at_wall(walls, names[int(rng.integers(len(names)))], rng) for _ in range(number))


def _post_at_wall(walls: Walled, name: str, rng: np.random.Generator) -> Post:
    radius_m, height_m = rng.uniform(0.008, 0.025), rng.uniform(0.04, 0.11)
    side, along = int(rng.integers(4)), rng.uniform(0.15, 0.85)
    gap_m = radius_m + 0.002
    x_m = walls.west_m + along * (walls.east_m - walls.west_m)
    y_m = walls.south_m + along * (walls.north_m - walls.south_m)
    places = [
        (walls.west_m + gap_m, y_m),
        (walls.east_m - gap_m, y_m),
        (x_m, walls.south_m + gap_m),
        (x_m, walls.north_m - gap_m),
    ]
    return Post(*places[side], name, radius_m, height_m)


def sorted_bands(scene: Scene, camera: Pose, own: Pose) -> list[Band]:
    """The bands of all bodies and posts, the farthest first; a body around `own` is the observer itself."""
    bands = [post_band(post) for post in scene.posts]
    for body in scene.bodies:
        if body.pose.distance_m(own) > SKIRT_RADIUS_M:
            bands += body_bands(body)
    distance = {id(band): math.hypot(band.x_m - camera.x_m, band.y_m - camera.y_m) for band in bands}
    visible = [band for band in bands if distance[id(band)] > band.radius_m + 0.001]
    return sorted(visible, key=lambda band: distance[id(band)], reverse=True)


WALL_HEIGHT_M = 0.12
WALL = np.array(COLOURS["white"])
FLOOR = np.array([0.42, 0.41, 0.39])
LAMP_THETA_RAD = 2.2
"""The side that the brighter light comes from, in the arena frame."""


class Surfaces:
    """Textures drawn once for each camera; `texture` scales their contrast."""

    def __init__(self, texture: float, rng: np.random.Generator) -> None:
        grain = _smooth(rng.standard_normal((256, 256)), 1.0)
        patches = _smooth(rng.standard_normal((256, 256)), 12.0)
        self.floor = np.maximum(1 + texture * (0.05 * grain + 0.04 * patches), 0.2).astype(np.float32)
        stains = _smooth(rng.standard_normal((4096, 1)), 6.0)[:, 0]
        self.stains = np.maximum(1 + texture * 0.012 * stains, 0.2)
        self.panorama = _panorama(rng)


def _smooth(noise: NDArray[np.float64], sd: float) -> NDArray[np.float64]:
    """Noise blurred over `sd` samples, with a standard deviation of one."""
    size = (0, 0) if min(noise.shape) > 1 else (1, 2 * int(3 * sd) + 1)
    blurred = np.asarray(cv2.GaussianBlur(noise, size, sigmaX=sd, sigmaY=sd), dtype=np.float64)
    return np.asarray((blurred - blurred.mean()) / blurred.std())


def _panorama(rng: np.random.Generator) -> NDArray[np.float32]:
    """Blurred furniture and windows, shape (3, 512 bearings, 64 elevations of 0.01 rad)."""
    grey = _smooth(rng.standard_normal((512, 64)), 7.0)
    tint = np.stack([_smooth(rng.standard_normal((512, 64)), 9.0) for _ in range(3)])
    light = 0.25 * np.exp(0.6 * grey) * np.exp(0.2 * tint)
    return np.clip(light, 0.02, 1.1).astype(np.float32)
