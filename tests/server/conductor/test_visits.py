"""When learners watch: at the start, every so many tracks, until the memory is full; never two at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from google.protobuf.message import Message

from server.conductor.carrier import SimulatedCarrier
from server.conductor.earlier import EarlierProgress
from server.conductor.visits import REPEAT_NS, Visits
from server.reporter import Reporter
from swarm.config.experiment import (
    Experiment,
    LearningSettings,
    RobotSettings,
    Role,
    RunSettings,
    VisitSettings,
)
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic

EXPERT = RobotSettings("expert", (0.0, 0.0), role=Role.EXPERT)
PUPIL = RobotSettings("pupil", (1.5, 0.0), watches="expert")
RIVAL = RobotSettings("rival", (1.5, 1.5), watches="expert")
LEFT = RobotSettings("left", (0.0, 0.0), watches="right")
RIGHT = RobotSettings("right", (1.5, 0.0), watches="left")


class Conducted:
    """The visits of an experiment, and everything that was ordered."""

    def __init__(self, *robots: RobotSettings, every_tracks: int = 10, capacity: int = 10) -> None:
        self.experiment = Experiment(
            RunSettings("visits"),
            robots,
            learning=LearningSettings(capacity=capacity),
            visits=VisitSettings(every_tracks=every_tracks),
        )
        self.sent: list[tuple[Topic[Any], Message, str]] = []
        reporter = Reporter(self)
        self.visits = Visits(self.experiment, reporter, SimulatedCarrier(reporter))

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        self.sent.append((topic, message, robot))

    def due(self, t_ns: int = 0) -> list[str]:
        """Who is ordered to watch now."""
        self.sent.clear()
        self.visits.order_due(t_ns)
        return [robot for _, order, robot in self.orders() if order.kind == pb.Order.WATCH]

    def orders(self) -> list[tuple[Topic[Any], pb.Order, str]]:
        return [
            (topic, message, robot) for topic, message, robot in self.sent if isinstance(message, pb.Order)
        ]

    def carries(self) -> list[tuple[str, pb.Carry]]:
        return [(robot, message) for _, message, robot in self.sent if isinstance(message, pb.Carry)]

    def says(self, robot: str, phase: pb.Visit.Phase.ValueType, visit: int) -> None:
        self.visits.heard(robot, pb.Visit(visit=visit, phase=phase))

    def make_visit(self, robot: str, visit: int, *, learns: bool = True) -> None:
        """From the order to the way home."""
        self.says(robot, pb.Visit.READY, visit)
        self.says(robot, pb.Visit.WATCHING, visit)
        if learns:
            self.visits.path_remembered(robot)
        self.says(robot, pb.Visit.DONE, visit)


def test_visits_at_the_start_and_every_ten_tracks() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    assert conducted.due() == ["pupil"]
    conducted.make_visit("pupil", 1)
    visited_at = []
    for track in range(1, 35):
        conducted.visits.track_ended("pupil", track)
        if conducted.due():
            visited_at.append(track)
            conducted.make_visit("pupil", 1 + len(visited_at))
    assert visited_at == [10, 20, 30]


def test_a_full_memory_ends_the_visits() -> None:
    conducted = Conducted(EXPERT, PUPIL, every_tracks=1, capacity=3)
    visits = 0
    for track in range(1, 20):
        if conducted.due():
            visits += 1
            conducted.make_visit("pupil", visits)
        conducted.visits.track_ended("pupil", track)
    assert visits == 3


def test_a_visit_from_which_nothing_was_learnt_does_not_fill_the_memory() -> None:
    conducted = Conducted(EXPERT, PUPIL, every_tracks=1, capacity=1)
    assert conducted.due() == ["pupil"]
    conducted.make_visit("pupil", 1, learns=False)
    assert conducted.due() == [], "the next moment is the next one in the list"
    conducted.visits.track_ended("pupil", 1)
    assert conducted.due() == ["pupil"]


def test_given_paths_take_room() -> None:
    given = replace(PUPIL, paths=(("SE",) * 5,))
    assert Conducted(EXPERT, given, capacity=1).due() == []


def test_a_visit_is_one_order_while_it_lasts() -> None:
    conducted = Conducted(EXPERT, PUPIL, every_tracks=1)
    conducted.due()
    conducted.visits.track_ended("pupil", 5)
    assert conducted.due() == []


def test_an_agent_that_restarts_during_a_visit_hears_the_order_again() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    conducted.due()
    conducted.says("pupil", pb.Visit.READY, 1)
    assert conducted.due(REPEAT_NS - 1) == []
    assert conducted.due(REPEAT_NS) == ["pupil"]
    ((_, order, _),) = conducted.orders()
    assert order.visit == 1
    conducted.make_visit("pupil", 1)
    assert conducted.due(3 * REPEAT_NS) == []


def test_a_demonstrator_has_one_watcher_at_a_time() -> None:
    conducted = Conducted(EXPERT, PUPIL, RIVAL)
    assert conducted.due() == ["pupil"]
    assert conducted.due() == []
    conducted.make_visit("pupil", 1)
    assert conducted.due() == ["rival"]


def test_two_that_copy_each_other_take_turns() -> None:
    """While one watches, the other is at home and shows something."""
    conducted = Conducted(LEFT, RIGHT)
    assert conducted.due() == ["left"]
    assert conducted.due() == []
    conducted.make_visit("left", 1)
    assert conducted.due() == ["right"]
    assert conducted.due() == []
    conducted.make_visit("right", 1)
    assert conducted.due() == []


def test_a_robot_is_carried_when_it_is_ready_and_home_when_it_is_done() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    conducted.due()
    assert conducted.carries() == []
    assert conducted.visits.watching == {}
    conducted.says("pupil", pb.Visit.READY, 1)
    ((robot, there),) = conducted.carries()
    assert robot == "pupil"
    assert [there.x_m, there.y_m] == pytest.approx([1.25, -0.05])
    assert conducted.visits.watching == {"pupil": "expert"}
    conducted.says("pupil", pb.Visit.DONE, 1)
    home = conducted.carries()[-1][1]
    assert [home.x_m, home.y_m] == pytest.approx([1.56, 1.14]), "its own start cell"
    topic, order, robot = conducted.orders()[-1]
    assert (topic, order.kind, robot) == (topics.ORDER, pb.Order.RUN, "pupil")
    assert conducted.visits.watching == {}


def test_words_of_another_visit_or_from_nowhere_change_nothing() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    conducted.due()
    conducted.sent.clear()
    conducted.says("pupil", pb.Visit.READY, 7)
    conducted.says("expert", pb.Visit.READY, 1)
    conducted.says("stranger", pb.Visit.DONE, 1)
    assert conducted.sent == []


def test_the_place_is_outside_the_goal_cell() -> None:
    """The demonstrator enters the goal cell: an observer inside it, as in the paper, would be run over."""
    conducted = Conducted(EXPERT, PUPIL)
    compartment = conducted.experiment.compartment(EXPERT)
    place = conducted.experiment.observers_place(EXPERT)
    assert compartment.state_at(place.x_m, place.y_m) is None
    goal = compartment.centre(compartment.grid.goal)
    robots_touch_m = 0.08
    assert max(abs(place.x_m - goal[0]), abs(place.y_m - goal[1])) > robots_touch_m


def test_visits_are_counted_on_from_those_of_the_last_server() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    conducted.visits.take_up("pupil", EarlierProgress(tracks=12, copied_paths=2, visits=2, visits_over=2))
    assert conducted.due() == []
    conducted.visits.track_ended("pupil", 20)
    assert conducted.due() == ["pupil"]
    ((_, order, _),) = conducted.orders()
    assert order.visit == 3


def test_a_visit_that_the_last_server_s_end_interrupted_is_over_and_the_robot_goes_home() -> None:
    conducted = Conducted(EXPERT, PUPIL)
    conducted.visits.take_up("pupil", EarlierProgress(tracks=5, visits=1))
    assert conducted.due() == []
    ((_, order, robot),) = conducted.orders()
    assert (robot, order.kind, order.visit) == ("pupil", pb.Order.RUN, 1)
    assert [robot for robot, _ in conducted.carries()] == ["pupil"]
    assert conducted.due() == []


def test_a_memory_that_was_full_stays_full() -> None:
    conducted = Conducted(EXPERT, PUPIL, capacity=3)
    conducted.visits.take_up("pupil", EarlierProgress(tracks=100, copied_paths=3, visits=3, visits_over=3))
    assert conducted.due() == []
