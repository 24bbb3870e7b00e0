"""What real tracking systems have in common: bodies with names, in axes of their own, seen at a moment."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.geometry import Pose
from tracker_bridge.arena_frame import ArenaFrame, Placement
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.protocols.cursor import Quaternion, Vector

DRIVEN_M = 0.02
"""A direction over 2 cm is right within 0.1 rad if positions are right within 1 mm."""


@dataclass(frozen=True, slots=True)
class Body:
    """A tracked body in the system's own axes and unit."""

    name: str
    position: Vector
    rotation: Quaternion | None
    """None if the system sees a point: then the robot faces where it drives."""
    residual_m: float = 0.0
    quality: float = 0.0


class Roster:
    """Which body is which robot, and where the system's axes lie in the arena."""

    def __init__(self, experiment: Experiment, unit_m: float) -> None:
        """`unit_m` is the system's own unit, unless the experiment names another."""
        self._robots = {robot.body or robot.id: robot for robot in experiment.robot}
        self._ids = {robot.id for robot in experiment.robot}
        if len(self._robots) < len(experiment.robot):
            raise UserError("two robots have the same body: every [[robot]] needs one of its own")
        self._frame = arena_frame(experiment, unit_m)
        self._drives: dict[str, DrivenHeading] = {}

    def tracked(
        self, bodies: Iterable[Body], captured_t_ns: int, received_t_ns: int, source_t_ns: int = 0
    ) -> Iterator[TrackedPose]:
        """The robots; a body that belongs to none keeps its own name, unless that is a robot's."""
        for body in bodies:
            robot = self._robots.get(body.name)
            placed = self._placed(body, robot.body_turn_rad if robot else 0.0)
            if placed is None:
                continue
            yield TrackedPose(
                robot.id if robot else self._stranger(body.name),
                placed.pose,
                captured_t_ns,
                received_t_ns,
                max(0, source_t_ns),
                body.residual_m,
                body.quality,
                placed.height_m,
                placed.tilt_rad,
            )

    def _stranger(self, name: str) -> str:
        return f"body {name}" if name in self._ids else name

    def _placed(self, body: Body, turn_rad: float) -> Placement | None:
        if body.rotation:
            return self._frame.placed(body.position, body.rotation, turn_rad)
        x_m, y_m, height_m = self._frame.point(body.position)
        heading_rad = self._drives.setdefault(body.name, DrivenHeading()).heading_rad(x_m, y_m)
        return None if heading_rad is None else Placement(Pose(x_m, y_m, heading_rad), height_m, None)


class DrivenHeading:
    """The heading of a robot that is seen as a point: the direction of its last centimetres, forwards."""

    def __init__(self) -> None:
        self._from_m: tuple[float, float] | None = None
        self._heading_rad: float | None = None

    def heading_rad(self, x_m: float, y_m: float) -> float | None:
        """None until it has driven."""
        if self._from_m is None:
            self._from_m = (x_m, y_m)
        dx_m, dy_m = x_m - self._from_m[0], y_m - self._from_m[1]
        if math.hypot(dx_m, dy_m) >= DRIVEN_M:
            self._from_m, self._heading_rad = (x_m, y_m), math.atan2(dy_m, dx_m)
        return self._heading_rad


def arena_frame(experiment: Experiment, unit_m: float) -> ArenaFrame:
    """The frame that the experiment's [tracker] table describes; UserError if it describes none."""
    settings = experiment.tracker
    try:
        return ArenaFrame.of(settings.axes, settings.unit_m or unit_m, settings.origin_m, settings.turn_rad)
    except ValueError as error:
        raise UserError(f"[tracker] axes is {error}") from error
