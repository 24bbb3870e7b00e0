"""Where to look for a demonstrator that is not in the image."""

from __future__ import annotations

from robot_agent.imitation.seeing import NotSeen, Reason, Sighting
from swarm.clock import NS_PER_S
from swarm.geometry import wrap_angle_rad

SEARCH_AFTER_NS = NS_PER_S
SWEEP_RAD = 0.6
"""To either side of the first heading: with half a field of view, more than the corner opens to."""
REACHED_RAD = 0.1
OUT_OF_IMAGE = (Reason.NOT_SEEN, Reason.CUT_OFF, Reason.UNLIKE)
"""Turning helps against these; it does not against darkness, or something that stands before the skirt."""


class Search:
    """Sweeps the compartment once the demonstrator has been out of the image for a second.

    It begins on the side on which the demonstrator was seen last.
    """

    def __init__(self, began_ns: int) -> None:
        self._seen_ns = began_ns
        self._middle_rad: float | None = None
        self._side = 1.0
        self._sweeping = False

    def towards_rad(
        self, answer: Sighting | NotSeen, own_theta_rad: float, towards_rad: float | None
    ) -> float | None:
        """The heading to turn to after a frame: as it was, unless the demonstrator has been lost for long."""
        if self._middle_rad is None:
            self._middle_rad = own_theta_rad
        if isinstance(answer, Sighting):
            self._seen_ns, self._sweeping = answer.t_ns, False
            return towards_rad
        if answer.reason not in OUT_OF_IMAGE or answer.t_ns - self._seen_ns < SEARCH_AFTER_NS:
            return towards_rad
        if not self._sweeping:
            self._sweeping = True
            aside_rad = wrap_angle_rad(own_theta_rad - self._middle_rad)
            self._side = 1.0 if aside_rad >= 0 else -1.0
        goal_rad = wrap_angle_rad(self._middle_rad + self._side * SWEEP_RAD)
        if abs(wrap_angle_rad(goal_rad - own_theta_rad)) < REACHED_RAD:
            self._side = -self._side
            goal_rad = wrap_angle_rad(self._middle_rad + self._side * SWEEP_RAD)
        return goal_rad
