"""Lets learners watch at the paper's moments: at the start, then every ten tracks until the memory is full.

One robot at a time watches a demonstrator; neither is visiting or being watched otherwise meanwhile.
"""

from __future__ import annotations

from dataclasses import dataclass

from server.conductor.carrier import Carrier
from server.conductor.earlier import EarlierProgress
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, RobotSettings
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics

REPEAT_NS = 10 * NS_PER_S
"""Matters only to an agent that restarted within a visit, which stands for so long at most."""


@dataclass
class VisitRecord:
    """Where a learner stands with its visits."""

    robot: RobotSettings
    begun: int = 0
    paths: int = 0
    tracks: int = 0
    ordered_ns: int = 0
    """When the order to watch was given last."""
    under_way: bool = False
    carried: bool = False
    """At the observer's place, or on its way there."""
    interrupted: bool = False
    """Under way when the trial's last server ended."""


class Visits:
    """Orders visits and has the robots carried."""

    def __init__(self, experiment: Experiment, reporter: Reporter, carrier: Carrier) -> None:
        self._experiment = experiment
        self._reporter = reporter
        self._carrier = carrier
        self._records = {robot.id: VisitRecord(robot) for robot in experiment.learners if robot.watches}
        for record in self._records.values():
            record.paths = len(record.robot.paths)

    @property
    def watching(self) -> dict[str, str]:
        """Observers at their places, each with the robot that it watches."""
        return {name: record.robot.watches for name, record in self._records.items() if record.carried}

    def take_up(self, robot: str, earlier: EarlierProgress) -> None:
        """Go on from where a learner was when the trial's last server ended."""
        record = self._records.get(robot)
        if record is not None:
            record.begun, record.tracks = earlier.visits, earlier.tracks
            record.paths += earlier.copied_paths
            record.interrupted = earlier.visits > earlier.visits_over

    def track_ended(self, robot: str, tracks: int) -> None:
        """A learner has made so many journeys to its goal."""
        if robot in self._records:
            self._records[robot].tracks = tracks

    def path_remembered(self, robot: str) -> None:
        """A learner's memory holds one more path."""
        if robot in self._records:
            self._records[robot].paths += 1

    def heard(self, robot: str, visit: pb.Visit) -> None:
        """A robot says how its visit goes."""
        record = self._records.get(robot)
        if record is None or not record.under_way or visit.visit != record.begun:
            return
        if visit.phase == pb.Visit.READY:
            place = self._experiment.observers_place(self._demonstrator(record))
            record.carried = True
            self._carrier.relocate(robot, place, f"visit {visit.visit} to {record.robot.watches}")
        elif visit.phase == pb.Visit.DONE:
            self._send_home(record)

    def order_due(self, t_ns: int) -> None:
        """Order every visit that is due and possible; repeat those under way, for an agent that restarted.

        A visit that a server's end interrupted is over: nobody knows what the observer was told meanwhile.
        """
        for record in self._records.values():
            if record.interrupted:
                record.interrupted = False
                self._send_home(record)
            elif self._is_due(record) and self._is_possible(record):
                record.begun += 1
                record.under_way = True
                self._order_to_watch(record, t_ns)
            elif record.under_way and t_ns - record.ordered_ns >= REPEAT_NS:
                self._order_to_watch(record, t_ns)

    def _is_due(self, record: VisitRecord) -> bool:
        moment = record.begun * self._experiment.visits.every_tracks
        has_room = record.paths < self._experiment.learning.capacity
        return has_room and record.tracks >= moment and not record.under_way

    def _is_possible(self, record: VisitRecord) -> bool:
        taken = {other.robot.watches for other in self._records.values() if other.under_way}
        demonstrator = self._records.get(record.robot.watches)
        is_away = demonstrator is not None and demonstrator.under_way
        return record.robot.watches not in taken and record.robot.id not in taken and not is_away

    def _send_home(self, record: VisitRecord) -> None:
        record.under_way = record.carried = False
        home = self._experiment.compartment(record.robot)
        start = Pose(*home.centre(home.grid.start), 0.0)
        self._carrier.relocate(record.robot.id, start, f"visit {record.begun} is over")
        self._order(record, pb.Order.RUN, start)

    def _order_to_watch(self, record: VisitRecord, t_ns: int) -> None:
        record.ordered_ns = t_ns
        self._order(record, pb.Order.WATCH, self._experiment.observers_place(self._demonstrator(record)))

    def _order(self, record: VisitRecord, kind: pb.Order.Kind.ValueType, place: Pose) -> None:
        order = pb.Order(
            kind=kind, visit=record.begun, x_m=place.x_m, y_m=place.y_m, theta_rad=place.theta_rad
        )
        self._reporter.publish(topics.ORDER, order, record.robot.id)

    def _demonstrator(self, record: VisitRecord) -> RobotSettings:
        return self._experiment.robot_named(record.robot.watches)
