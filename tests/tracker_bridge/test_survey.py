"""What `check` and `watch` say of what arrived."""

from __future__ import annotations

import math

from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.datagrams import Arrivals
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.survey import MOST_STRANGERS, Survey, table

PERIOD_NS = 10_000_000


def surveyed(alter: float = 1.0) -> Survey:
    """Two seconds of robot a at 100 Hz, each pose 3 ms after its receipt; b is missing; a wand passes by."""
    survey = Survey(tracked_experiment(TrackerSettings(backend="vicon")))
    for number in range(200):
        t_ns = number * PERIOD_NS
        pose = Pose(alter * (0.5 + 0.001 * number), alter * 0.5, 0.0)
        seen = TrackedPose("a", pose, t_ns, t_ns, residual_m=0.0004, quality=0.75)
        survey.take([seen, seen._replace(robot="Wand")], t_ns + 3_000_000)
    return survey


def test_a_report_says_who_how_often_how_late_and_who_not() -> None:
    arrivals = Arrivals()
    arrivals.count("10.0.0.5:51001")
    report = surveyed().report(2.0, arrivals)
    (robot,) = report.robots
    assert (robot.robot, robot.poses, robot.rate_hz) == ("a", 200, 100.0)
    assert (robot.latency_p50_ms, robot.latency_p99_ms, robot.longest_gap_ms) == (3.0, 3.0, 10.0)
    assert (robot.residual_mm, robot.quality, robot.refused) == (0.4, 0.75, {})
    assert (report.missing, report.strangers, report.mistakes) == (["b"], {"Wand": 200}, [])
    assert report.senders == {"10.0.0.5:51001": 1}


def test_a_report_for_a_person_has_all_of_it() -> None:
    arrivals = Arrivals()
    arrivals.count("10.0.0.5:51001")
    arrivals.refused["cut short"] += 3
    text = table(surveyed(1000.0).report(2.0, arrivals))
    for said in ("10.0.0.5:51001", "cut short", "b  ", "not seen", "Wand", "millimetres", "outside 200"):
        assert said in text


def test_invented_names_do_not_fill_the_memory() -> None:
    survey = Survey(tracked_experiment(TrackerSettings()))
    for number in range(10 * MOST_STRANGERS):
        survey.take([TrackedPose(f"body {number}", Pose(0.0, 0.0, math.pi), number)], number)
    assert len(survey.report(1.0, Arrivals()).strangers) == MOST_STRANGERS + 1
