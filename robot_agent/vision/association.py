"""What a robot can have done since it was last seen: keeps a look-alike from being taken for it."""

from __future__ import annotations

import math
from dataclasses import dataclass

FASTEST_M_S = 0.15
"""The e-puck's 0.129 m/s (1000 steps/s of 0.1288 mm) with a margin."""
FASTEST_TURN_RAD_S = 1.6
"""Of the observer itself, when it does not say how far it turned."""
RANGE_SLACK_M = 0.015
"""Chosen: for what the errors' model leaves out, such as a tilted robot."""
BEARING_SLACK_RAD = 0.03
"""Chosen: 1.7 degrees, for the same."""
DEVIATIONS = 4.0
"""Chosen: a true detection is refused once in 16,000 frames if its error is normal."""
MEMORY_NS = 10_000_000_000
"""At 0.10 m/s a robot can cross most of a compartment in this time, and may be anywhere."""


@dataclass(frozen=True)
class Place:
    """Where the demonstrator is thought to be, seen from the camera."""

    t_ns: int
    range_m: float
    bearing_rad: float
    range_sd_m: float


class Association:
    """Remembers the last place for ten seconds; then the robot can be anywhere."""

    def __init__(self) -> None:
        self._last: Place | None = None
        self._turned_rad = 0.0
        self._turn_known = True

    def turn(self, turned_rad: float | None) -> None:
        """The camera turned (counter-clockwise) since the frame before; None if that is not known."""
        if turned_rad is None:
            self._turn_known = False
        else:
            self._turned_rad += turned_rad

    def keep(self, place: Place) -> None:
        self._last, self._turned_rad, self._turn_known = place, 0.0, True

    def forget(self) -> None:
        self._last, self._turned_rad, self._turn_known = None, 0.0, True

    def remembers(self, t_ns: int) -> bool:
        return self._last is not None and 0 <= t_ns - self._last.t_ns <= MEMORY_NS

    def strain(self, place: Place) -> float:
        """How far a place is from where the robot was, in parts of the farthest it can have got (1: just)."""
        if self._last is None or not self.remembers(place.t_ns):
            return 0.0
        moved_m = FASTEST_M_S * (place.t_ns - self._last.t_ns) * 1e-9
        noise_m = DEVIATIONS * math.hypot(place.range_sd_m, self._last.range_sd_m)
        range_strain = abs(place.range_m - self._last.range_m) / (moved_m + noise_m + RANGE_SLACK_M)
        swing_rad = moved_m / max(min(place.range_m, self._last.range_m), 0.05) + BEARING_SLACK_RAD
        if not self._turn_known:
            swing_rad += FASTEST_TURN_RAD_S * (place.t_ns - self._last.t_ns) * 1e-9
        expected_rad = self._last.bearing_rad - self._turned_rad
        return max(range_strain, abs(place.bearing_rad - expected_rad) / swing_rad)
