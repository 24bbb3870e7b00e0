"""Robots named by the pins of their hats in clouds of unnamed markers.

Groups of markers are found by an index of distances, followed by continuity, and named when the evidence of
several clouds leaves one hat. A name holds as long as the group is followed and does not speak against it.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from swarm.clock import NS_PER_S
from swarm.geometry import Pose, wrap_angle_rad
from tracker_bridge.hats.alignment import Points, align
from tracker_bridge.hats.bodies import MOST_PINS, Body, Sightings, sight
from tracker_bridge.hats.constellations import DistanceIndex
from tracker_bridge.hats.evidence import Catalogue, margin
from tracker_bridge.hats.hat_events import HatEvent, HatHistory, stray
from tracker_bridge.hats.patterns import Hat
from tracker_bridge.hats.strays import StrayWatch

Mask = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.int64]

HELD_NS = NS_PER_S // 5
"""A body that is not seen for longer is given up; in this time an e-puck goes 26 mm, less than its radius."""
TWO_PINS_NS = NS_PER_S
"""For so long a body may be followed by two pins alone: two markers at a distance are of many hats."""
NEAR_HAT = {2: 3.0, 3: 1.5}
"""By the pins seen, in radii of the largest hat: a point so near to a hat that lacks pins may be of a hat in
its place. By two pins the hat's middle may be wrong by more than a radius."""
SURE = 20.0
"""Logarithm of the likelihoods' ratio at which a group is named: wrong by chance once in 5e8."""
FEWEST_SIGHTINGS = {4: 3, 3: 100}
"""By pins: a second of clouds at 100 Hz before a group of three is taken for a hat that lost a pin."""
GROUP_NOISES = 4.0
"""Markers of a new group fit a pattern to so many standard deviations."""
MEAN_MISFIT, LARGEST_DOUBT, ANOTHER_HAT = 9.0, 12.0, 25.0
"""In units of the noise's variance; 5 is expected of four pins and 25 or more of another hat's."""
POOR_FIT, BETTER_FIT = 11.0, 2.0
"""Worse than 95 of 100 sightings of the hat itself, and by so many times better: then it is another's."""
DOUBT_GAIN = 0.1
"""Of the moving average of misfits, whose standard deviation is then 0.7 of those units."""


@dataclass(frozen=True)
class TrackedHat:
    """A named hat and where it is; `residual_m` is the root mean square of its pins' distances."""

    name: str
    pose: Pose
    residual_m: float
    pins_seen: int


class HatTracker:
    """Finds and names hats of four pins, cloud by cloud; `noise_m` is a marker's deviation in x and in y."""

    def __init__(self, hats: list[Hat], noise_m: float = 0.001) -> None:
        self._pins = np.array([hat.pins for hat in hats])
        self._noise_m = noise_m
        self._reach_m = float(np.abs(self._pins).max())
        self._catalogue = Catalogue(self._pins)
        kept = [list(pins) for pins in combinations(range(MOST_PINS), MOST_PINS - 1)]
        without_one = self._pins[:, kept].reshape(-1, MOST_PINS - 1)
        patterns = (self._pins, without_one)
        self._indices = [DistanceIndex(each, GROUP_NOISES * noise_m) for each in patterns]
        self._bodies: list[Body] = []
        self._history = HatHistory(hats)
        self._strays = StrayWatch()

    def update(self, points: Points, t_ns: int) -> tuple[list[TrackedHat], list[HatEvent]]:
        """Take the next cloud: (n,) places in the arena, x + iy in metres, in any order."""
        tracked: list[TrackedHat] = []
        events: list[HatEvent] = []
        free = np.ones(len(points), dtype=np.bool_)
        if self._bodies:
            sightings = sight(self._bodies, points, t_ns, self._noise_m)
            free = _unexplained(points, sightings.markers[sightings.believed])
            named = np.array([body.hat is not None for body in self._bodies])
            unnamed = _unexplained(points, sightings.markers[sightings.believed & named])
            tracked = self._tracked(sightings, points, points[unnamed])
            for number in np.flatnonzero(sightings.believed):
                events += self._see(int(number), sightings, points, t_ns)
        events += self._give_up(points[free], t_ns)
        self._begin(points, free, t_ns)
        return tracked, events + [stray(place) for place in self._strays.watch(points[free], t_ns)]

    def _see(self, number: int, sightings: Sightings, points: Points, t_ns: int) -> list[HatEvent]:
        """Take a believed sighting into a body's motion and into the evidence about its name."""
        body, markers = self._bodies[number], sightings.markers[number]
        body.move(complex(sightings.middles[number]), float(sightings.angles_rad[number]), t_ns)
        seen = int((markers >= 0).sum())
        whole = seen == body.size
        if seen >= 3:
            body.sure_ns = t_ns
        if body.hat is None:
            return self._consider(body, points[markers[: body.size]], t_ns) if whole else []
        if whole:
            body.doubt_m2 += DOUBT_GAIN * (float(sightings.misfits_m2[number]) - body.doubt_m2)
        return self._history.pins(body, (markers >= 0).tolist(), t_ns)

    def _consider(self, body: Body, group: Points, t_ns: int) -> list[HatEvent]:
        """Add a sighting of all its pins to the evidence about an unnamed body; name it when that is sure."""
        misfits_m2 = self._catalogue.misfits_m2(group)
        body.misfits_m2 = misfits_m2 if body.misfits_m2 is None else body.misfits_m2 + misfits_m2
        body.sightings += 1
        if body.sightings < FEWEST_SIGHTINGS[body.size]:
            return []
        named = [other.hat for other in self._bodies if other.hat is not None]
        misfits_m2 = body.misfits_m2
        if body.size < MOST_PINS:  # hats share three pins: who is seen elsewhere is out of the question
            misfits_m2 = self._catalogue.without(misfits_m2, named)
        hat, way = self._catalogue.way(int(misfits_m2.argmin()), body.size)
        if float(misfits_m2.min()) / body.sightings > MEAN_MISFIT * self._noise_m**2:
            return []
        if margin(misfits_m2, self._noise_m) < SURE:
            return self._history.ambiguous(hat, body.middle) if body.size < MOST_PINS else []
        if hat in named:
            return self._history.twice(hat, body.middle)
        self._name(body, hat, way, group, t_ns)
        return self._history.named(hat, body.middle)

    def _name(self, body: Body, hat: int, way: list[int], group: Points, t_ns: int) -> None:
        pins = self._pins[hat]
        middle, turn = align(pins[way], group)
        body.velocity_m_s += 1j * body.spin_rad_s * (complex(middle) - body.middle)
        body.pins, body.hat = pins, hat
        body.middle, body.angle_rad = complex(middle), cmath.phase(complex(turn))
        body.doubt_m2 = 5 * self._noise_m**2  # what is expected of four pins
        body.pin_seen_ns = [t_ns] * MOST_PINS

    def _tracked(self, sightings: Sightings, points: Points, unnamed: Points) -> list[TrackedHat]:
        """Believed sightings of named bodies, without those that may show another hat in its place;
        `unnamed` are the points that are of no named body."""
        tracked = []
        for number in np.flatnonzero(sightings.believed):
            body, markers = self._bodies[number], sightings.markers[number]
            middle, misfit_m2 = complex(sightings.middles[number]), float(sightings.misfits_m2[number])
            if body.hat is None:
                continue
            if self._may_be_another(middle, misfit_m2, points[markers[markers >= 0]], unnamed):
                body.doubt_m2 += DOUBT_GAIN * (ANOTHER_HAT * self._noise_m**2 - body.doubt_m2)
                continue
            pose = Pose(middle.real, middle.imag, wrap_angle_rad(float(sightings.angles_rad[number])))
            seen = int(sightings.seen[number])
            name = self._history.hats[body.hat].name
            tracked.append(TrackedHat(name, pose, (misfit_m2 / seen) ** 0.5, seen))
        return tracked

    def _may_be_another(self, middle: complex, misfit_m2: float, group: Points, unnamed: Points) -> bool:
        """Whether a pin is missing beside a point that is of no named body, or the group fits badly and
        another hat, or another order of the pins, better."""
        if len(group) < MOST_PINS:
            return _beside(middle, unnamed, NEAR_HAT[len(group)] * self._reach_m)
        is_poor = misfit_m2 > POOR_FIT * self._noise_m**2
        return is_poor and float(self._catalogue.misfits_m2(group).min()) < misfit_m2 / BETTER_FIT

    def _give_up(self, free: Points, t_ns: int) -> list[HatEvent]:
        """Drop bodies that are lost or doubted, and groups of three beside which a fourth marker appeared."""
        events, kept = [], []
        for body in self._bodies:
            lost = t_ns - body.seen_ns > HELD_NS or t_ns - body.sure_ns > TWO_PINS_NS
            doubted = body.doubt_m2 > LARGEST_DOUBT * self._noise_m**2
            if body.hat is not None and (lost or doubted):
                events.append(self._history.left(body.hat, body.middle, "lost" if lost else "doubted"))
            elif not lost and (body.size == MOST_PINS or not _beside(body.middle, free, 2 * self._reach_m)):
                kept.append(body)
        self._bodies = kept
        return events

    def _begin(self, points: Points, free: Mask, t_ns: int) -> None:
        """New bodies from points that nothing explains; groups of four first."""
        for index in self._indices:
            left = np.flatnonzero(free)
            for group in index.groups(points[left]):
                members = left[list(group)]
                self._bodies.append(Body.of_group(points[members], t_ns))
                free[members] = False


def _unexplained(points: Points, markers: Numbers) -> Mask:
    """(n,): which points are of none of some bodies; -1 is a pin that is not seen."""
    free = np.ones(len(points), dtype=np.bool_)
    free[markers[markers >= 0]] = False
    return free


def _beside(middle: complex, free: Points, reach_m: float) -> bool:
    """Whether a point that nothing explains is so near that it may be a body's missing pin."""
    return bool(len(free)) and float(np.abs(free - middle).min()) < reach_m
