"""The arrays that the ray tracer reads, from a scene."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tests.support.judge.scene import Appearance, Box, Colour, Image, Lamp, Post, Scene

Records = Any

SURFACE = np.dtype([(name, np.float64) for name in ("red", "green", "blue", "specular", "shininess")])
CYLINDER = np.dtype(
    [(name, np.float64) for name in ("x", "y", "bottom", "top", "radius")]
    + [(name, np.float64) for name in ("theta", "opening_rad", "opening_bottom", "opening_top")]
    + [("surface", np.int64), ("opening_surface", np.int64)]
)
BOX = np.dtype(
    [(name, np.float64) for name in ("x", "y", "cos", "sin", "half_length", "half_width", "top")]
    + [("surface", np.int64)]
)
BALL = np.dtype([(name, np.float64) for name in ("x", "y", "z", "radius")] + [("surface", np.int64)])

DARK: Colour = (0.02, 0.02, 0.022)
BOARD: Colour = (0.02, 0.10, 0.04)
SILVER: Colour = (0.55, 0.55, 0.57)

CAMERA_HOLE_M = 0.028  # height of the e-puck's camera above the floor
BOARD_RADIUS_M, BOARD_THICKNESS_M = 0.033, 0.0016  # round boards a little inside the body of 7 cm
BOARD_PITCH_M = 0.012  # height of the connectors between two stacked boards
CORE_RADIUS_M = 0.018  # connectors and battery, seen between the boards
PIN_PITCH_M, PIN_RADIUS_M, PIN_HEIGHT_M = 0.013, 0.0009, 0.022
BALL_RADIUS_M = 0.0045  # the smaller reflective spheres that tracking systems use
BALL_PINS = ((0, 0), (0, 3), (2, 1), (3, 3), (3, 0))  # a pattern without symmetry


class World(NamedTuple):
    """A scene as arrays: the first `robot_cylinders` cylinders and all balls lie within `bound`.

    `pins` holds one cylinder around all pins, or none.
    """

    cylinders: Records
    boxes: Records
    balls: Records
    surfaces: Records
    pins: Records
    robot_cylinders: int
    bound: tuple[float, float, float]
    """x, y, radius of an upright cylinder around the robot"""
    lamp: tuple[float, float, float, float, float]
    """x, y, z, power at one metre, ambient"""
    floor: Image
    floor_tile: float
    floor_gloss: float
    panorama: Image
    panorama_top: float


class _Collection:
    """Primitives in the order of adding, and the surfaces that they name by number."""

    def __init__(self) -> None:
        self.surfaces: list[tuple[float, ...]] = []
        self.cylinders: list[tuple[float, ...]] = []
        self.balls: list[tuple[float, ...]] = []

    def surface(self, colour: Colour, specular: float = 0.0, shininess: float = 1.0) -> int:
        self.surfaces.append((*colour, specular, shininess))
        return len(self.surfaces) - 1

    def cylinder(self, x: float, y: float, bottom: float, top: float, radius: float, surface: int) -> None:
        self.cylinders.append((x, y, bottom, top, radius, 0.0, 0.0, 0.0, 0.0, surface, surface))


def world(scene: Scene) -> World:
    """The arrays of a scene."""
    parts = _Collection()
    _add_robot(parts, scene)
    robot_cylinders = len(parts.cylinders)
    for post in scene.posts:
        _add_post(parts, post)
    boxes = [_box(parts, box) for box in scene.boxes]
    # Half a centimetre around the widest part: its edges are sampled finely from both sides.
    radius_m = max(scene.appearance.skirt_radius_m, scene.appearance.hat_radius_m, BOARD_RADIUS_M) + 0.005
    return World(
        np.array(parts.cylinders, CYLINDER),
        np.array(boxes, BOX),
        np.array(parts.balls, BALL),
        np.array(parts.surfaces, SURFACE),
        np.array(_pin_zone(scene), CYLINDER),
        robot_cylinders,
        (scene.robot.x_m, scene.robot.y_m, radius_m),
        _lamp(scene.lamp),
        scene.floor,
        scene.floor_tile_m,
        scene.floor_gloss,
        scene.panorama,
        scene.panorama_top_rad,
    )


def _lamp(lamp: Lamp) -> tuple[float, float, float, float, float]:
    return lamp.x_m, lamp.y_m, lamp.z_m, lamp.power * lamp.reference_m**2, lamp.ambient


def _add_post(parts: _Collection, post: Post) -> None:
    surface = parts.surface(post.colour, specular=0.05, shininess=20.0)
    parts.cylinder(post.x_m, post.y_m, 0.0, post.height_m, post.radius_m, surface)


def _box(parts: _Collection, box: Box) -> tuple[float, ...]:
    cos, sin = math.cos(box.theta_rad), math.sin(box.theta_rad)
    surface = parts.surface(box.colour)
    return box.x_m, box.y_m, cos, sin, box.length_m / 2, box.width_m / 2, box.height_m, surface


def _add_robot(parts: _Collection, scene: Scene) -> None:
    look, x, y = scene.appearance, scene.robot.x_m, scene.robot.y_m
    dark = parts.surface(DARK, specular=0.1, shininess=10.0)
    _add_skirt(parts, scene, dark)
    parts.cylinder(x, y, 0.0, look.skirt_bottom_m, 0.8 * look.skirt_radius_m, dark)
    if look.hat is None:
        return
    _add_boards(parts, scene, dark)
    hat = parts.surface(look.hat, specular=0.04, shininess=8.0)
    parts.cylinder(x, y, look.hat_bottom_m, look.hat_top_m, look.hat_radius_m, hat)
    if look.pins:
        _add_pins(parts, scene)


def _add_skirt(parts: _Collection, scene: Scene, dark: int) -> None:
    look = scene.appearance
    red = parts.surface(look.skirt, look.skirt_specular, shininess=25.0)
    hole_rad, half_m = look.opening_m / 2 / look.skirt_radius_m, look.opening_m / 2
    hole = (scene.robot.theta_rad, hole_rad, CAMERA_HOLE_M - half_m, CAMERA_HOLE_M + half_m)
    side = (scene.robot.x_m, scene.robot.y_m, look.skirt_bottom_m, look.skirt_top_m, look.skirt_radius_m)
    parts.cylinders.append((*side, *hole, red, dark))
    _add_lid(parts, look, scene, dark)


def _add_lid(parts: _Collection, look: Appearance, scene: Scene, dark: int) -> None:
    """The skirt is a ring around the motherboard: from above one looks on the board, not on red."""
    lid_m = look.skirt_top_m + 0.0002
    parts.cylinder(scene.robot.x_m, scene.robot.y_m, look.skirt_top_m, lid_m, BOARD_RADIUS_M, dark)


def _add_boards(parts: _Collection, scene: Scene, dark: int) -> None:
    """The Linux board and the speaker board, in the gap between skirt and hat."""
    look, x, y = scene.appearance, scene.robot.x_m, scene.robot.y_m
    parts.cylinder(x, y, look.skirt_top_m, look.hat_bottom_m, CORE_RADIUS_M, dark)
    board = parts.surface(BOARD, specular=0.1, shininess=20.0)
    for height_m in np.arange(look.skirt_top_m + BOARD_PITCH_M, look.hat_bottom_m, BOARD_PITCH_M):
        parts.cylinder(x, y, height_m, height_m + BOARD_THICKNESS_M, BOARD_RADIUS_M, board)


def _pin_zone(scene: Scene) -> list[tuple[float, ...]]:
    look, x, y = scene.appearance, scene.robot.x_m, scene.robot.y_m
    top_m = look.hat_top_m + PIN_HEIGHT_M + BALL_RADIUS_M
    zone = (x, y, look.hat_top_m, top_m, look.hat_radius_m, 0.0, 0.0, 0.0, 0.0, 0, 0)
    return [zone] if look.pins and look.hat is not None else []


def _add_pins(parts: _Collection, scene: Scene) -> None:
    """Four by four pins that turn with the robot, and reflective spheres on some of them."""
    top_m = scene.appearance.hat_top_m
    pin, ball = parts.surface(SILVER, 0.2, 20.0), parts.surface(SILVER, 0.3, 6.0)
    cos, sin = math.cos(scene.robot.theta_rad), math.sin(scene.robot.theta_rad)
    for row, column in np.ndindex(4, 4):
        forward_m, left_m = (row - 1.5) * PIN_PITCH_M, (column - 1.5) * PIN_PITCH_M
        x = scene.robot.x_m + cos * forward_m - sin * left_m
        y = scene.robot.y_m + sin * forward_m + cos * left_m
        parts.cylinder(x, y, top_m, top_m + PIN_HEIGHT_M, PIN_RADIUS_M, pin)
        if (row, column) in BALL_PINS:
            parts.balls.append((x, y, top_m + PIN_HEIGHT_M, BALL_RADIUS_M, ball))
