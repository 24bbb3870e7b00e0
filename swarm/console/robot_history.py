"""Where one robot was and how it did, at any time of a run."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

from swarm.config.experiment import Experiment, RobotSettings
from swarm.console.learning_history import LearningHistory
from swarm.geometry import Pose, wrap_angle_rad
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header

STATUS_EVERY_S = 5.0
"""Of statuses with the same activity one in so many seconds is kept: 50 robots' ten hours fit in memory."""

LATEST_S = 2.0
"""A pose is older than this when it comes only if the tracker's clock is another one."""

T = TypeVar("T")


class StatusAt(NamedTuple):
    """What a robot said of itself."""

    t_s: float
    activity: str
    moves: int
    tracks: int
    pose_age_s: float
    bad_messages: int
    battery_v: float
    failed_exchanges: int


class VisitAt(NamedTuple):
    """A phase of a visit."""

    t_s: float
    visit: int
    phase: str
    path: int
    reason: str


class ObservationAt(NamedTuple):
    """The ledger of one visit, told at its end."""

    t_s: float
    message: pb.Observation


class CopyErrorAt(NamedTuple):
    """What a copied path has wrong."""

    t_s: float
    message: pb.CopyError


class Track:
    """Poses by time, in columns: ten hours of one robot take 7 MB."""

    def __init__(self) -> None:
        self.t_s = array("d")
        self.x_m = array("f")
        self.y_m = array("f")
        self.theta_rad = array("f")

    def add(self, t_s: float, captured_s: float, pose: pb.Pose) -> None:
        """A pose that came at one time and was captured at another, which counts if it makes sense."""
        sensible = 0 <= t_s - captured_s < LATEST_S
        self.t_s.append(max(captured_s if sensible else t_s, self.t_s[-1] if self.t_s else 0.0))
        self.x_m.append(pose.x_m)
        self.y_m.append(pose.y_m)
        self.theta_rad.append(pose.theta_rad)

    def at(self, t_s: float) -> tuple[float, Pose] | None:
        """The newest pose by a time, and when it came."""
        place = bisect_right(self.t_s, t_s) - 1
        if place < 0:
            return None
        return self.t_s[place], self._pose(place)

    def between(self, t_s: float) -> Pose | None:
        """Where it was at a time, on the line between the poses before and after."""
        place = bisect_right(self.t_s, t_s)
        if not 0 < place < len(self.t_s):
            found = self.at(t_s)
            return found[1] if found else None
        before, after = self._pose(place - 1), self._pose(place)
        share = (t_s - self.t_s[place - 1]) / (self.t_s[place] - self.t_s[place - 1])
        turn_rad = wrap_angle_rad(after.theta_rad - before.theta_rad)
        return Pose(
            before.x_m + share * (after.x_m - before.x_m),
            before.y_m + share * (after.y_m - before.y_m),
            wrap_angle_rad(before.theta_rad + share * turn_rad),
        )

    def heading_about(self, t_s: float, within_s: float) -> float | None:
        """The mean of the headings so near a time; a tracker's headings are noisier than its places."""
        first, end = bisect_left(self.t_s, t_s - within_s), bisect_right(self.t_s, t_s + within_s)
        headings = self.theta_rad[first:end]
        return math.atan2(sum(map(math.sin, headings)), sum(map(math.cos, headings))) if headings else None

    def _pose(self, place: int) -> Pose:
        return Pose(self.x_m[place], self.y_m[place], self.theta_rad[place])

    def count(self, since_s: float, until_s: float) -> int:
        """Poses after the one time, up to the other."""
        return bisect_right(self.t_s, until_s) - bisect_right(self.t_s, since_s)

    def places(self, since_s: float, until_s: float, at_most: int) -> list[tuple[float, float, float]]:
        """(t_s, x_m, y_m) between two times, evenly thinned out to so many."""
        first, end = bisect_right(self.t_s, since_s), bisect_right(self.t_s, until_s)
        step = max(1, -(-(end - first) // at_most))
        chosen = range(end - 1, first - 1, -step)[::-1]
        return [(self.t_s[i], self.x_m[i], self.y_m[i]) for i in chosen]


class Numbers:
    """The numbers of one key's messages: how many came, and how many are missing in between."""

    def __init__(self) -> None:
        self._epoch = 0
        self._last = 0
        self.received = 0
        self.lost = 0

    def add(self, header: Header) -> None:
        self.received += 1
        if header.epoch == self._epoch and header.sequence > self._last:
            self.lost += header.sequence - self._last - 1
        self._epoch, self._last = header.epoch, header.sequence


class RobotHistory:
    """Everything that was said by one robot or about it."""

    def __init__(self, experiment: Experiment, settings: RobotSettings) -> None:
        self.settings = settings
        self.compartment = experiment.compartment(settings)
        self.learning = LearningHistory(self.compartment.grid.states, experiment.learning.capacity)
        self.track = Track()
        self.statuses: list[StatusAt] = []
        self.visits: list[VisitAt] = []
        self.observations: list[ObservationAt] = []
        self.copy_errors: list[CopyErrorAt] = []
        self.numbers: dict[str, Numbers] = defaultdict(Numbers)
        """By key."""

    @property
    def received(self) -> int:
        return sum(numbers.received for numbers in self.numbers.values())

    @property
    def lost(self) -> int:
        return sum(numbers.lost for numbers in self.numbers.values())

    def add_status(self, t_s: float, status: pb.Status) -> None:
        last = self.statuses[-1] if self.statuses else None
        if last and last.activity == status.activity and t_s - last.t_s < STATUS_EVERY_S:
            return
        self.statuses.append(
            StatusAt(
                t_s,
                status.activity,
                status.moves,
                status.tracks,
                status.pose_age_s,
                status.bad_messages,
                status.battery_v,
                status.failed_exchanges,
            )
        )

    def add_visit(self, t_s: float, visit: pb.Visit) -> None:
        phase = pb.Visit.Phase.Name(visit.phase).lower()
        self.visits.append(VisitAt(t_s, visit.visit, phase, visit.path, visit.reason))


def newest(entries: Sequence[T], t_s: float) -> T | None:
    """The last of timed entries by a time."""
    place = place_at(entries, t_s)
    return entries[place - 1] if place else None


def place_at(entries: Sequence[Any], t_s: float) -> int:
    """How many of timed entries there were by a time."""
    return bisect_right(entries, t_s, key=lambda entry: entry.t_s)
