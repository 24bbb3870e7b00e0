"""Frames of the emulated camera."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from tracker_bridge.emulators.camera.optics import Optics, Station
from tracker_bridge.emulators.camera.rays import on_plate, through_body
from tracker_bridge.emulators.camera.scene import Faults, Swarm, TagPlate

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float32]

SUBPIXELS = 4
"""Rays a pixel in each direction, each at its own moment of the exposure."""
BODY_GREY, PAPER_GREY, INK_GREY = 55.0, 225.0, 25.0
"""Of a robot, and of a laser print under full light."""
BODY_MARGIN_M = 0.01


@dataclass(frozen=True)
class _Box:
    left: int
    top: int
    right: int
    bottom: int


class CameraRenderer:
    """Renders grey frames of robots with tags; `floor` is what the camera sees without robots or light.

    `codes` gives the modules of each tag: (n, n) with 1 for white, the black border included.
    """

    def __init__(
        self,
        optics: Optics,
        station: Station,
        plate: TagPlate,
        faults: Faults,
        codes: dict[int, Grey],
        floor: Grey,
        rng: np.random.Generator,
    ) -> None:
        self.optics, self.station, self.plate, self.faults = optics, station, plate, faults
        self._codes = _printed(codes)
        self._floor = floor.astype(np.float32)
        self._rng = rng
        self._origin = station.place.astype(np.float32)
        self._rays = _rays(optics, station)
        self._light = _light(optics, faults)
        self._moments = _moments(rng)

    def with_plates(self, plate: TagPlate, codes: dict[int, Grey]) -> CameraRenderer:
        """The same camera over the same floor with other plates: boards, or tags on the floor."""
        other = copy(self)
        other.plate, other._codes = plate, _printed(codes)
        return other

    def render(self, swarm: Swarm) -> Grey:
        """(height, width): one exposure, with the robots at `swarm.poses` in the middle of it."""
        picture = self._floor.copy()
        for number in self._from_the_edge(swarm):
            self._draw(picture, swarm, number)
        picture *= self._light
        return self._sensed(picture)

    def _from_the_edge(self, swarm: Swarm) -> list[int]:
        """Outer robots first: the camera sees an inner robot's plate before an outer robot's body."""
        away = np.hypot(swarm.poses[:, 0] - self.station.x_m, swarm.poses[:, 1] - self.station.y_m)
        return [int(number) for number in np.argsort(-away)]

    def _draw(self, picture: Floats, swarm: Swarm, number: int) -> None:
        box = self._box(swarm.poses[number])
        if box is None:
            return
        rays = _subpixel_rays(self._rays, box)
        centre, theta_rad = self._centre_at(self._moments_in(box), swarm, number)
        tilt_rad = (0.0, 0.0) if swarm.tilts_rad is None else tuple(swarm.tilts_rad[number])
        ahead_m, left_m = on_plate(self._origin, rays, centre, theta_rad, (tilt_rad[0], tilt_rad[1]))
        plain = picture[box.top : box.bottom, box.left : box.right]
        seen = np.broadcast_to(plain[..., None], ahead_m.shape).copy()
        seen[through_body(self._origin, rays, centre, self.plate.body_radius_m)] = BODY_GREY
        hidden = 0.0 if swarm.hidden is None else float(swarm.hidden[number])
        self._print(seen, ahead_m, left_m, self._codes[swarm.ids[number]], hidden)
        plain[:] = seen.mean(-1)

    def _print(self, seen: Floats, ahead_m: Floats, left_m: Floats, code: Floats, hidden: float) -> None:
        """Put a plate and the tag on it where rays meet them."""
        half_m, side_m, modules = self.plate.half_m, self.plate.side_m, code.shape[0]
        on = (np.abs(ahead_m) < half_m) & (np.abs(left_m) < half_m)
        row = np.floor((0.5 - ahead_m[on] / side_m) * modules).astype(np.int32)
        column = np.floor((0.5 - left_m[on] / side_m) * modules).astype(np.int32)
        paper = np.pad(code, 1, constant_values=PAPER_GREY)
        grey = paper[np.clip(row, -1, modules) + 1, np.clip(column, -1, modules) + 1]
        grey[left_m[on] > half_m * (1 - 2 * hidden)] = BODY_GREY
        seen[on] = grey

    def _centre_at(self, moments_s: Floats, swarm: Swarm, number: int) -> tuple[Floats, Floats]:
        pose = swarm.poses[number].astype(np.float32)
        velocity = swarm.velocities[number].astype(np.float32)
        height_m = np.full_like(moments_s, self.plate.height_m)
        x_m, y_m = pose[0] + velocity[0] * moments_s, pose[1] + velocity[1] * moments_s
        return np.stack([x_m, y_m, height_m], -1), pose[2] + velocity[2] * moments_s

    def _moments_in(self, box: _Box) -> Floats:
        """(rows, columns, subpixels): when each ray is seen, from the middle of the middle row's exposure."""
        rows = np.arange(box.top, box.bottom, dtype=np.float32) - self.optics.height / 2
        shape = (box.bottom - box.top, box.right - box.left, SUBPIXELS**2)
        moments_s = self.faults.exposure_s * self._moments + self.faults.row_delay_s * rows[:, None, None]
        return np.broadcast_to(moments_s, shape).astype(np.float32)

    def _box(self, pose: npt.NDArray[np.float64]) -> _Box | None:
        """The pixels that a robot can cover; None outside the picture."""
        reach_m = max(self.plate.half_m * math.sqrt(2), self.plate.body_radius_m) + BODY_MARGIN_M
        corners = [
            (pose[0] + east * reach_m, pose[1] + north * reach_m, height_m)
            for east in (-1, 1)
            for north in (-1, 1)
            for height_m in (0.0, self.plate.height_m + BODY_MARGIN_M)
        ]
        directions = (np.array(corners) - self.station.place) @ self.station.axes
        u, v = self.optics.distorted(directions[:, 0] / directions[:, 2], directions[:, 1] / directions[:, 2])
        left, right = max(0, int(u.min())), min(self.optics.width, int(u.max()) + 2)
        top, bottom = max(0, int(v.min())), min(self.optics.height, int(v.max()) + 2)
        return _Box(left, top, right, bottom) if left < right and top < bottom else None

    def _sensed(self, picture: Floats) -> Grey:
        """What lens and sensor make of the light."""
        faults = self.faults
        if faults.defocus_px > 0:
            picture = cv2.GaussianBlur(picture, (0, 0), faults.defocus_px).astype(np.float32)
        spread = faults.noise_levels * np.sqrt(0.5 + picture / 255.0)
        picture = picture + spread * self._rng.standard_normal(picture.shape, dtype=np.float32)
        grey = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
        if not faults.jpeg_quality:
            return grey
        coded = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, faults.jpeg_quality])[1]
        return np.asarray(cv2.imdecode(coded, cv2.IMREAD_GRAYSCALE), dtype=np.uint8)


def _printed(codes: dict[int, Grey]) -> dict[int, Floats]:
    return {tag: np.where(code, PAPER_GREY, INK_GREY).astype(np.float32) for tag, code in codes.items()}


def _rays(optics: Optics, station: Station) -> Floats:
    """(height + 1, width + 1, 3): the rays through the pixels' upper left corners."""
    v, u = np.mgrid[: optics.height + 1, : optics.width + 1] - 0.5
    x, y = optics.directions(u, v)
    rays = np.stack([x, y, np.ones_like(x)], -1) @ station.axes.T
    return rays.astype(np.float32)


def _subpixel_rays(rays: Floats, box: _Box) -> Floats:
    """(rows, columns, subpixels, 3): rays within the pixels of a box, between those of their corners."""
    first = rays[box.top : box.bottom, box.left : box.right, None]
    right = rays[box.top : box.bottom, box.left + 1 : box.right + 1, None] - first
    down = rays[box.top + 1 : box.bottom + 1, box.left : box.right, None] - first
    part = (np.arange(SUBPIXELS, dtype=np.float32) + 0.5) / SUBPIXELS
    across, along = (axis.reshape(-1, 1) for axis in np.meshgrid(part, part))
    return np.asarray(first + across * right + along * down)


def _moments(rng: np.random.Generator) -> Floats:
    """(subpixels,): when each is seen, in parts of the exposure; evenly spread, in no order."""
    count = SUBPIXELS**2
    return ((rng.permutation(count) + 0.5) / count - 0.5).astype(np.float32)


def _light(optics: Optics, faults: Faults) -> Floats:
    """(height, width): daylight that falls off across the picture, and a lamp."""
    v, u = np.mgrid[: optics.height, : optics.width].astype(np.float32)
    slope = (u / optics.width + v / optics.height) / 2
    even = 1.0 - (1.0 - faults.darkest_light) * slope
    lamp = np.exp(-(((u - 0.3 * optics.width) ** 2 + (v - 0.35 * optics.height) ** 2) / (250.0**2)))
    return np.asarray(even * (1.0 + faults.lamp_spot * lamp) / (1.0 + faults.lamp_spot), dtype=np.float32)
