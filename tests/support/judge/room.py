"""Compartments with low white walls in a furnished room, drawn from a generator."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np

from swarm.geometry import Pose
from tests.support.judge.scene import WHITE, Appearance, Box, Colour, Image, Lamp, Post, Scene

HALLS = Path(__file__).parents[2] / "data" / "halls"
GAMMA = 2.2  # of the recorded pictures, undone to mix them with light
WALL_THICKNESS_M = 0.015
FURNITURE = 8
FURNITURE_COLOURS: tuple[Colour, ...] = (
    (0.42, 0.24, 0.11),  # wood
    (0.25, 0.13, 0.06),  # dark wood
    (0.30, 0.30, 0.31),  # steel
    (0.06, 0.12, 0.30),  # a blue chair
    (0.35, 0.06, 0.05),  # a red cushion
    (0.05, 0.05, 0.05),  # a bag
)
FLOOR_TEXELS = 128


def furnished_room(
    robot: Pose,
    appearance: Appearance,
    generator: np.random.Generator,
    side_m: float = 1.2,
    *,
    posts: int = 0,
    posts_inside: bool = False,
) -> Scene:
    """A square compartment, south-west corner at the origin, in a room with things in it.

    The room depends on the generator alone: the same seed gives the same one to every robot and appearance.
    """
    wall_m = generator.uniform(0.10, 0.25)
    furniture = [_furniture(generator, side_m) for _ in range(FURNITURE)]
    return Scene(
        robot,
        appearance,
        _lamp(generator, side_m),
        _floor(generator),
        _panorama(generator),
        (*_walls(side_m, wall_m), *furniture),
        tuple(_post(generator, side_m, index / posts, posts_inside) for index in range(posts)),
    )


def _walls(side_m: float, height_m: float) -> list[Box]:
    middle_m, out_m = side_m / 2, WALL_THICKNESS_M / 2
    length_m = side_m + 2 * WALL_THICKNESS_M
    places = [(side_m + out_m, middle_m), (middle_m, side_m + out_m), (-out_m, middle_m), (middle_m, -out_m)]
    return [
        Box(x_m, y_m, math.pi / 2 * (quarter + 1), length_m, WALL_THICKNESS_M, height_m, WHITE)
        for quarter, (x_m, y_m) in enumerate(places)
    ]


def _beyond(
    generator: np.random.Generator, side_m: float, turn_rad: float, low_m: float, high_m: float
) -> Pose:
    """A place that far outside the walls, in a direction from the middle, facing it."""
    reach_m = side_m / 2 / max(abs(math.cos(turn_rad)), abs(math.sin(turn_rad)))
    away_m = reach_m + generator.uniform(low_m, high_m)
    middle = Pose(side_m / 2, side_m / 2, turn_rad)
    return middle.compose(Pose(away_m, 0.0, math.pi))


def _furniture(generator: np.random.Generator, side_m: float) -> Box:
    place = _beyond(generator, side_m, generator.uniform(-math.pi, math.pi), 1.2, 3.0)
    length_m, width_m, height_m = generator.uniform((0.3, 0.3, 0.4), (1.2, 0.7, 1.8))
    colour = FURNITURE_COLOURS[generator.integers(len(FURNITURE_COLOURS))]
    return Box(place.x_m, place.y_m, place.theta_rad, width_m, length_m, height_m, colour)


def _post(generator: np.random.Generator, side_m: float, turn: float, inside: bool) -> Post:
    """A post of nearly the skirt's red: a thin one along the wall inside, or any one behind the wall."""
    turn_rad = (turn + generator.uniform(0.0, 0.1)) * math.tau
    if inside:  # two centimetres at the wall are out of reach of a robot in the outer cells
        place = _beyond(generator, side_m, turn_rad, -0.012, -0.010)
        radius_m, height_m = generator.uniform((0.007, 0.05), (0.010, 0.25))
    else:
        place = _beyond(generator, side_m, turn_rad, 0.05, 0.5)
        radius_m, height_m = generator.uniform((0.015, 0.4), (0.05, 0.9))
    red, green, blue = generator.uniform((0.40, 0.02, 0.02), (0.65, 0.10, 0.08))
    return Post(place.x_m, place.y_m, radius_m, height_m, (red, green, blue))


def _lamp(generator: np.random.Generator, side_m: float) -> Lamp:
    """A ceiling lamp, up to two metres aside of the compartment."""
    x_m, y_m = side_m / 2 + generator.uniform(-2.0, 2.0, 2)
    return Lamp(x_m, y_m, generator.uniform(2.0, 3.0), reference_m=2.5)


def _floor(generator: np.random.Generator) -> Image:
    """A tile of linoleum: coarse clouds and fine grain that repeat without a seam, brighter or darker."""
    grain = generator.standard_normal((FLOOR_TEXELS, FLOOR_TEXELS)).astype(np.float32)
    clouds = cv2.GaussianBlur(np.tile(grain, (3, 3)), (0, 0), 5)[
        FLOOR_TEXELS:-FLOOR_TEXELS, FLOOR_TEXELS:-FLOOR_TEXELS
    ]
    pattern = 1 + 0.10 * clouds / clouds.std() + 0.04 * grain
    tint = generator.uniform(0.25, 0.5) * generator.uniform(0.92, 1.08, 3)
    return np.ascontiguousarray((np.clip(pattern, 0.3, 1.7)[..., None] * tint).astype(np.float32))


def _panorama(generator: np.random.Generator) -> Image:
    """The recorded halls side by side and mirrored, so that they meet; turned at random."""
    order = generator.permutation(sorted(HALLS.glob("hall-*.jpg")))
    halls = [_linear(path) for path in order]
    ring = np.concatenate([side for hall in halls for side in (hall, hall[:, ::-1])], axis=1)
    return np.ascontiguousarray(np.roll(ring, generator.integers(ring.shape[1]), axis=1))


def _linear(path: Path) -> Image:
    """Radiance (rows, columns, 3), red first, of a recorded picture."""
    picture = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if picture is None:
        raise FileNotFoundError(f"no picture can be read from {path}")
    return ((picture[..., ::-1] / 255.0) ** GAMMA).astype(np.float32)
