"""What stands before the camera: the paper's robot (figure 22), a lamp, walls and things.

Lengths in metres; colours are linear reflectances (red, green, blue) from 0 to 1; the arena frame has
x east, y north, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import Pose

Colour = tuple[float, float, float]
Image = NDArray[np.float32]

RED: Colour = (0.55, 0.035, 0.03)
YELLOW: Colour = (0.75, 0.52, 0.03)
BLACK: Colour = (0.03, 0.03, 0.03)
WHITE: Colour = (0.8, 0.8, 0.78)


@dataclass(frozen=True)
class Appearance:
    """The robot's coverings; the skirt's top and the hat's underside leave the boards open between them.

    The defaults follow figure 22 on a body of 7 cm by 5 cm: the paper gives no sizes of skirt and hat, so
    each is free. `opening_m` is the width and height of the hole that the robot's own camera looks through.
    """

    skirt: Colour = RED
    skirt_radius_m: float = 0.0355
    skirt_bottom_m: float = 0.006
    skirt_top_m: float = 0.046
    skirt_specular: float = 0.12
    opening_m: float = 0.010
    hat: Colour | None = YELLOW
    hat_radius_m: float = 0.036
    hat_gap_m: float = 0.030
    hat_height_m: float = 0.008
    pins: bool = False

    @property
    def hat_bottom_m(self) -> float:
        """Where the hat begins; a gap of 0 lays it on the skirt."""
        return self.skirt_top_m + self.hat_gap_m

    @property
    def hat_top_m(self) -> float:
        return self.hat_bottom_m + self.hat_height_m


@dataclass(frozen=True)
class Lamp:
    """A point of white light, and what the room throws back.

    A surface that faces the lamp at `reference_m` and reflects everything has radiance `ambient` + `power`;
    radiance 1 saturates the sensor at exposure 1.
    """

    x_m: float
    y_m: float
    z_m: float
    power: float = 0.75
    ambient: float = 0.3
    reference_m: float = 2.0


@dataclass(frozen=True)
class Post:
    """An upright cylinder on the floor."""

    x_m: float
    y_m: float
    radius_m: float
    height_m: float
    colour: Colour


@dataclass(frozen=True)
class Box:
    """A wall or a piece of furniture on the floor: `length_m` lies along `theta_rad`."""

    x_m: float
    y_m: float
    theta_rad: float
    length_m: float
    width_m: float
    height_m: float
    colour: Colour


@dataclass(frozen=True)
class Scene:
    """All that a camera can see. The robot stands at `robot`; its heading turns skirt opening and pins.

    `floor` is a tile (rows, columns, 3) of side `floor_tile_m` repeated over the floor, and
    mirrors by Fresnel's law times `floor_gloss`, 1 for a polished one; `panorama`
    (rows, columns, 3) surrounds the room at infinity: rows from `panorama_top_rad` of elevation down to the
    horizon, columns counter-clockwise from east.
    """

    robot: Pose
    appearance: Appearance
    lamp: Lamp
    floor: Image
    panorama: Image
    boxes: tuple[Box, ...] = ()
    posts: tuple[Post, ...] = ()
    floor_tile_m: float = 0.5
    floor_gloss: float = 0.0
    panorama_top_rad: float = 0.5
