"""From a tracking system's axes and unit to the arena frame, and back for emulators.

A system's axes are named by which of them point to the arena's east, north and up: "x y z" for a system whose
z is up, "x -z y" for Motive, whose y is up. The origin and the turn then say where the system's origin lies
in the arena, and how far its east is turned, counter-clockwise, from the arena's.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from swarm.geometry import Pose, wrap_angle_rad
from tracker_bridge.protocols.cursor import Quaternion, Vector

Axis = tuple[int, int]
"""The number of an axis, 0 to 2, and its sign."""

EXAMPLE = "'x y z', or 'x -z y' if y is up"


@dataclass(frozen=True, slots=True)
class Placement:
    """A pose in the arena frame, and what a flat pose leaves out."""

    pose: Pose
    height_m: float
    tilt_rad: float | None
    """How far the body's up is from the arena's: 0 for a robot on the floor; None if a point was seen."""


@dataclass(frozen=True)
class ArenaFrame:
    """The mapping of one tracking system."""

    east: Axis
    north: Axis
    up: Axis
    unit_m: float
    """Metres in one unit of the system."""
    origin_m: tuple[float, float] = (0.0, 0.0)
    turn_rad: float = 0.0

    @classmethod
    def of(cls, axes: str, unit_m: float, origin_m: tuple[float, float], turn_rad: float) -> ArenaFrame:
        """ValueError with the cure if the axes are not three different ones, or mirror the arena."""
        east, north, up = parsed_axes(axes)
        return cls(east, north, up, unit_m, origin_m, turn_rad)

    def placed(self, position: Vector, rotation: Quaternion, body_turn_rad: float = 0.0) -> Placement:
        """A body in the arena. One that is not rotated faces the arena's east, before turns."""
        forward = rotated(rotation, _along(self.east))
        theta_rad = math.atan2(_part(forward, self.north), _part(forward, self.east))
        upright = _part(rotated(rotation, _along(self.up)), self.up)
        x_m, y_m, height_m = self.point(position)
        heading_rad = wrap_angle_rad(theta_rad + self.turn_rad + body_turn_rad)
        return Placement(Pose(x_m, y_m, heading_rad), height_m, math.acos(max(-1.0, min(1.0, upright))))

    def point(self, position: Vector) -> Vector:
        """x, y and height in metres of the arena."""
        east_m = self.unit_m * _part(position, self.east)
        north_m = self.unit_m * _part(position, self.north)
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        return (
            self.origin_m[0] + cos * east_m - sin * north_m,
            self.origin_m[1] + sin * east_m + cos * north_m,
            self.unit_m * _part(position, self.up),
        )

    def seen(self, pose: Pose, height_m: float, body_turn_rad: float = 0.0) -> tuple[Vector, Quaternion]:
        """What the system would see of a robot at a pose: the inverse of `placed`."""
        moved = Pose(*self.origin_m, self.turn_rad).relative(pose)
        position = [0.0, 0.0, 0.0]
        parts = ((self.east, moved.x_m), (self.north, moved.y_m), (self.up, height_m))
        for (axis, sign), part_m in parts:
            position[axis] = sign * part_m / self.unit_m
        half_rad = (moved.theta_rad - body_turn_rad) / 2
        x, y, z = (math.sin(half_rad) * part for part in _along(self.up))
        return (position[0], position[1], position[2]), (x, y, z, math.cos(half_rad))


def parsed_axes(text: str) -> tuple[Axis, Axis, Axis]:
    """Three axes; ValueError unless they are different and right-handed, as every system here is."""
    found = re.fullmatch(r"(-?)([xyz]) +(-?)([xyz]) +(-?)([xyz])", text.strip())
    if not found or len({*found.group(2, 4, 6)}) < 3:
        raise ValueError(f"{text!r} does not name three axes for east, north and up, such as {EXAMPLE}")
    signs, names = found.group(1, 3, 5), found.group(2, 4, 6)
    east, north, up = (
        ("xyz".index(name), -1 if sign else 1) for sign, name in zip(signs, names, strict=True)
    )
    if handedness((east, north, up)) < 0:
        raise ValueError(f"{text!r} mirrors the arena: change the sign of one axis, or exchange two")
    return east, north, up


def handedness(axes: tuple[Axis, Axis, Axis]) -> int:
    """1 for right-handed axes, -1 for mirrored ones."""
    order = [axis for axis, _ in axes]
    is_cycle = order in ([0, 1, 2], [1, 2, 0], [2, 0, 1])
    return math.prod(sign for _, sign in axes) * (1 if is_cycle else -1)


def rotated(rotation: Quaternion, vector: Vector) -> Vector:
    """A vector turned by a quaternion of length 1."""
    x, y, z, w = rotation
    vx, vy, vz = vector
    cx, cy, cz = y * vz - z * vy + w * vx, z * vx - x * vz + w * vy, x * vy - y * vx + w * vz
    return vx + 2 * (y * cz - z * cy), vy + 2 * (z * cx - x * cz), vz + 2 * (x * cy - y * cx)


def from_rotation_vector(vector: Vector) -> Quaternion:
    """The rotation about a vector by its length in radians."""
    angle_rad = math.hypot(*vector)
    if angle_rad == 0.0:
        return 0.0, 0.0, 0.0, 1.0
    factor = math.sin(angle_rad / 2) / angle_rad
    return vector[0] * factor, vector[1] * factor, vector[2] * factor, math.cos(angle_rad / 2)


def from_xyz_angles(angles_rad: Vector) -> Quaternion:
    """The rotation R = Rx Ry Rz."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(angle / 2), math.sin(angle / 2)) for angle in angles_rad)
    return (
        sx * cy * cz + cx * sy * sz,
        cx * sy * cz - sx * cy * sz,
        cx * cy * sz + sx * sy * cz,
        cx * cy * cz - sx * sy * sz,
    )


def to_xyz_angles(rotation: Quaternion) -> Vector:
    """The angles of R = Rx Ry Rz: the inverse of `from_xyz_angles`."""
    x, y, z, w = rotation
    sine = max(-1.0, min(1.0, 2 * (x * z + w * y)))
    about_x = math.atan2(2 * (w * x - y * z), 1 - 2 * (x * x + y * y))
    about_z = math.atan2(2 * (w * z - x * y), 1 - 2 * (y * y + z * z))
    return about_x, math.asin(sine), about_z


def _along(axis: Axis) -> Vector:
    number, sign = axis
    return tuple(float(sign) if number == each else 0.0 for each in range(3))  # type: ignore[return-value]


def _part(vector: Vector, axis: Axis) -> float:
    number, sign = axis
    return sign * vector[number]
