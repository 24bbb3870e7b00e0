"""The rows of a judgement: named appearances, lights, lenses and rooms, each one step from the plain one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from swarm.geometry import Pose
from tests.support.judge.optics import Camera, Lens
from tests.support.judge.room import furnished_room
from tests.support.judge.scene import BLACK, WHITE, YELLOW, Appearance, Scene
from tests.support.judge.sensor import PixelFormat, Sensor

WARM = (1.2, 1.0, 0.8)
STRONGLY_WARM = (1.35, 1.0, 0.65)


@dataclass(frozen=True)
class Condition:
    """One row: pitch and roll are the camera's errors against its file, so the pipeline is not told them."""

    name: str
    appearance: Appearance = field(default_factory=Appearance)
    lens: Lens = field(default_factory=Lens)
    sensor: Sensor = field(default_factory=Sensor)
    width: int = 320
    height: int = 240
    pitch_deg: float = 0.0
    roll_deg: float = 0.0
    posts: int = 0
    posts_inside: bool = False
    floor_gloss: float = 0.0

    def camera(self, horizontal_fov_rad: float, height_m: float, forward_m: float) -> Camera:
        """The camera of a file with these figures, as it really sits on the robot."""
        pitch_rad, roll_rad = math.radians(self.pitch_deg), math.radians(self.roll_deg)
        place = (self.width, self.height, horizontal_fov_rad, height_m, forward_m)
        return Camera(*place, pitch_rad, roll_rad, self.lens)

    def scene(self, robot: Pose, generator: np.random.Generator, side_m: float = 1.2) -> Scene:
        """A random room around the robot; the same seed gives the same room in every row (but its posts)."""
        room = (robot, self.appearance, generator, side_m)
        scene = furnished_room(*room, posts=self.posts, posts_inside=self.posts_inside)
        return replace(scene, floor_gloss=self.floor_gloss)


def conditions(
    appearance: Appearance | None = None, pixel_format: PixelFormat = "rgb565"
) -> dict[str, Condition]:
    """The catalogue by name; `appearance` gives the skirt and hat that all rows but their own start from."""
    look = replace(appearance or Appearance(), hat=BLACK)
    plain = Condition("black hat", look, sensor=Sensor(pixel_format=pixel_format))
    rows = [plain, *_coverings(plain), *_lights(plain), *_cameras(plain), *_sizes(plain), *_rooms(plain)]
    rows += [_hard(plain)]
    return {row.name: row for row in rows}


def _coverings(plain: Condition) -> list[Condition]:
    look = plain.appearance
    looks = {
        "yellow hat": replace(look, hat=YELLOW),
        "yellow hat on the skirt": replace(look, hat=YELLOW, hat_gap_m=0.0),
        "white hat": replace(look, hat=WHITE),
        "no hat": replace(look, hat=None),
        "pins": replace(look, hat=YELLOW, pins=True),
        "radius 3.55": replace(look, skirt_radius_m=0.0355),
        "radius 3.40": replace(look, skirt_radius_m=0.0340),
    }
    return [replace(plain, name=name, appearance=look) for name, look in looks.items()]


def _lights(plain: Condition) -> list[Condition]:
    sensor = plain.sensor
    sensors = {
        "warm": replace(sensor, gains=WARM),
        "strongly warm": replace(sensor, gains=STRONGLY_WARM),
        "noise x3": replace(sensor, noise=3.0),
    }
    for exposure in (1.5, 0.5, 0.4, 0.3):
        sensors[f"exposure {exposure}"] = replace(sensor, exposure=exposure)
    return [replace(plain, name=name, sensor=sensor) for name, sensor in sensors.items()]


def _cameras(plain: Condition) -> list[Condition]:
    pitched = [replace(plain, name=f"pitch {degrees}", pitch_deg=float(degrees)) for degrees in (1, 2, 3, -3)]
    rolled = replace(plain, name="roll 3", roll_deg=3.0)
    blurred = replace(plain, name="blur 2", lens=replace(plain.lens, blur_px=2.0))
    straight = replace(plain, name="no distortion", lens=replace(plain.lens, k1=0.0))
    return [*pitched, rolled, blurred, straight]


def _sizes(plain: Condition) -> list[Condition]:
    sizes = ((160, 120), (320, 240), (640, 480))
    return [replace(plain, name=f"{width}x{height}", width=width, height=height) for width, height in sizes]


def _rooms(plain: Condition) -> list[Condition]:
    posts = replace(plain, name="six posts", posts=6)
    inside = replace(posts, name="six posts inside", posts_inside=True)
    # Waxed linoleum: half of a mirror's share, since its ripples scatter the rest.
    return [posts, inside, replace(plain, name="glossy floor", floor_gloss=0.5)]


def _hard(plain: Condition) -> Condition:
    """All at once: figure 22's robot among posts, warm and dim light, a crooked and blurred camera, noise."""
    return replace(
        plain,
        name="hard",
        appearance=replace(plain.appearance, hat=YELLOW, pins=True),
        lens=replace(plain.lens, blur_px=1.5),
        sensor=replace(plain.sensor, gains=WARM, exposure=0.5, noise=3.0),
        pitch_deg=2.0,
        roll_deg=3.0,
        posts=6,
    )
