"""Groups of markers that move as one body, followed from cloud to cloud."""

from __future__ import annotations

import cmath
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from swarm.clock import NS_PER_S
from tracker_bridge.hats.alignment import Points, align

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

GATE_M = 0.005
"""A marker is its pin's if it lies so near to where that is expected: five times a poor tracker's noise."""
DRIFT_M_PER_S = 0.06
"""The gate's growth while a body is not seen: half an e-puck's speed, for it may brake or turn."""
PLACE_GAIN, SPEED_GAIN = 0.6, 0.15
"""Of the alpha-beta filter that predicts; robots change speed within several clouds, noise within one."""
LEAST_STEP_S = 0.002
"""No tracker sends more than 500 clouds a second; two with nearly one time show a clock that was set."""
LIMITS = {2: 15.1, 3: 21.1, 4: 25.7}
"""Largest sums of squares in units of the noise's variance by pins seen: chi-squared with 2 k - 3 degrees
of freedom is above them once in 10,000."""
UNSEEN_WEIGHT = 0.5
"""Of a pin that is not seen, at its expected place: two pins 13 mm apart alone leave 6 degrees open."""
MOST_PINS = 4


@dataclass
class Body:
    """Pins (4,) about the body's own origin, nan for one that it does not have, and its motion."""

    pins: Points
    middle: complex
    angle_rad: float
    seen_ns: int
    velocity_m_s: complex = 0j
    spin_rad_s: float = 0.0
    hat: int | None = None
    misfits_m2: Floats | None = None
    """Summed over the sightings so far, one for each way to see a hat."""
    sightings: int = 0
    doubt_m2: float = 0.0
    """Moving average of the sum of squared residuals of sightings with all pins."""
    sure_ns: int = 0
    """When three or more of its pins were last seen."""
    pin_seen_ns: list[int] = field(default_factory=list)

    @classmethod
    def of_group(cls, points: Points, t_ns: int) -> Body:
        """An unnamed body: its origin is the middle of its markers."""
        middle = complex(points.mean())
        pins = np.full(MOST_PINS, np.nan, dtype=np.complex128)
        pins[: len(points)] = points - middle
        return cls(pins, middle, 0.0, t_ns, sure_ns=t_ns)

    @property
    def size(self) -> int:
        """Pins that the body has."""
        return int(np.isfinite(self.pins).sum())

    def predicted(self, t_ns: int) -> Points:
        """(4,): where its pins are expected."""
        ahead_s = (t_ns - self.seen_ns) / NS_PER_S
        turn = cmath.exp(1j * (self.angle_rad + self.spin_rad_s * ahead_s))
        return np.asarray(self.middle + self.velocity_m_s * ahead_s + turn * self.pins)

    def gate_m(self, t_ns: int) -> float:
        return GATE_M + DRIFT_M_PER_S * (t_ns - self.seen_ns) / NS_PER_S

    def move(self, middle: complex, angle_rad: float, t_ns: int) -> None:
        """Take a measured place and angle into the prediction."""
        ahead_s = (t_ns - self.seen_ns) / NS_PER_S
        expected = self.middle + self.velocity_m_s * ahead_s
        expected_rad = self.angle_rad + self.spin_rad_s * ahead_s
        beside = middle - expected
        turned_rad = cmath.phase(cmath.exp(1j * (angle_rad - expected_rad)))
        self.middle, self.angle_rad = expected + PLACE_GAIN * beside, expected_rad + PLACE_GAIN * turned_rad
        self.velocity_m_s += SPEED_GAIN * beside / max(ahead_s, LEAST_STEP_S)
        self.spin_rad_s += SPEED_GAIN * turned_rad / max(ahead_s, LEAST_STEP_S)
        self.seen_ns = t_ns


@dataclass(frozen=True)
class Sightings:
    """What a cloud shows of some bodies: the marker of each pin (-1: none), and the alignment."""

    markers: Numbers
    middles: Points
    angles_rad: Floats
    misfits_m2: Floats
    believed: Mask

    @property
    def seen(self) -> Numbers:
        """(n,): pins seen of each body."""
        return np.asarray((self.markers >= 0).sum(1))


def sight(bodies: list[Body], points: Points, t_ns: int, noise_m: float) -> Sightings:
    """Look for bodies in a cloud (n,) where they are expected.

    A marker goes to the nearest pin, and a pin takes the nearest marker: both must agree. A body is believed
    if two or more of its pins are seen and lie as they should.
    """
    pins = np.array([body.pins for body in bodies])
    expected = np.array([body.predicted(t_ns) for body in bodies])
    gates_m = np.repeat([body.gate_m(t_ns) for body in bodies], MOST_PINS)
    markers = _mutual(expected.ravel(), points, gates_m).reshape(expected.shape)
    seen = markers >= 0
    shown = np.where(seen, points[markers], expected) if len(points) else expected
    weights = np.where(seen, 1.0, UNSEEN_WEIGHT)
    absent = np.isnan(pins)
    pins, shown, weights = (np.where(absent, 0, each) for each in (pins, shown, weights))
    middles, turns = align(pins, shown, weights)
    missed_m2 = np.abs(shown - middles[:, None] - turns[:, None] * pins) ** 2
    misfits_m2 = np.where(seen, missed_m2, 0.0).sum(1)
    limits = np.array([0.0, 0.0, *(LIMITS[count] for count in sorted(LIMITS))])[seen.sum(1)] * noise_m**2
    unnamed = np.array([body.hat is None for body in bodies])  # their pins are themselves known by a sighting
    return Sightings(markers, middles, np.angle(turns), misfits_m2, misfits_m2 < limits * (1 + unnamed))


def _mutual(pins: Points, points: Points, gates_m: Floats) -> Numbers:
    """(pins,): each pin's point, -1 if none is within its gate or that one is nearer to another pin."""
    if not len(points) or not len(pins):
        return np.full(len(pins), -1)
    apart_m = np.abs(pins[:, None] - points)
    apart_m = np.where(np.isfinite(apart_m), apart_m, np.inf)
    nearest = apart_m.argmin(1)
    agreed = apart_m.argmin(0)[nearest] == np.arange(len(pins))
    within = apart_m[np.arange(len(pins)), nearest] < gates_m
    return np.where(agreed & within, nearest, -1)
