"""The obstacle reflex: a robot does not drive on towards what its proximity sensors say is too near.

It is the agent's own. The firmware's obstacle avoidance stays off, which would not let the wheels stop.
"""

from __future__ import annotations

from robot_agent.drivers.health import BodyHealth, TellsHealth
from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import WheelSpeeds, WheelSteps
from robot_agent.drivers.proximity import distance_m
from swarm.errors import UserError

FRONT = (0, 1, 6, 7)
"""Sensors within 46 degrees of the way ahead."""
BACK = (3, 4)
"""The two at 151 degrees."""


class ReflexBody:
    """A body that keeps the turning part of a command and drops what would bring it nearer to an obstacle."""

    def __init__(self, body: Body, health: TellsHealth, keep_off_m: float) -> None:
        self._body = body
        self._health = health
        self._keep_off_m = keep_off_m

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        forward = (speeds.left_steps_per_s + speeds.right_steps_per_s) / 2
        if forward and self._is_near(FRONT if forward > 0 else BACK):
            speeds = WheelSpeeds(speeds.left_steps_per_s - forward, speeds.right_steps_per_s - forward)
        return self._body.drive(speeds, t_ns)

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        return self._body.wheel_steps(t_ns)

    @property
    def health(self) -> BodyHealth:
        return self._health.health

    def close(self) -> None:
        self._body.close()

    def _is_near(self, sensors: tuple[int, ...]) -> bool:
        echoes = self.health.proximity
        return any(distance_m(echoes[sensor]) < self._keep_off_m for sensor in sensors)


def with_reflex(body: Body, keep_off_m: float) -> Body:
    """The body itself if the reflex is off (0). UserError if it has no proximity sensors."""
    if not keep_off_m:
        return body
    if not isinstance(body, TellsHealth):
        raise UserError("keep_off_m needs proximity sensors, of which this driver tells nothing: set it to 0")
    return ReflexBody(body, body, keep_off_m)
