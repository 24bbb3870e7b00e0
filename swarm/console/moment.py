"""What can be said of a run at one moment: where every robot is, what it does, how it is."""

from __future__ import annotations

from typing import Any

from swarm.clock import NS_PER_S
from swarm.console.enactment import move_under_way, path_under_way
from swarm.console.robot_history import RobotHistory, newest
from swarm.console.run_history import RunHistory

TRAIL_POINTS = 24
"""Of one robot between two frames: a second of poses at 20 Hz."""
RATE_WINDOW_S = 10.0
"""A hundred poses: a lost one shows as 1 %."""
PACE_KNOWN_AFTER = 10
"""Moves: their durations differ by a factor of five."""
SIGHTING_HOLDS_S = 0.3
"""A camera frame is shown until the next one at 5 a second, and a little longer."""


def frame(history: RunHistory, t_s: float, since_s: float) -> dict[str, Any]:
    """Everything that moves, with the places that each robot passed since an earlier moment."""
    phase = newest(history.phases, t_s)
    return {
        "kind": "frame",
        "t_s": round(t_s, 3),
        "phase": phase.phase if phase else "",
        "left_s": time_left_s(history, t_s),
        "robots": {name: _robot(history, robot, t_s, since_s) for name, robot in history.robots.items()},
    }


def time_left_s(history: RunHistory, t_s: float) -> float | None:
    """Until the slowest learner has made its moves at its pace so far; None while too few were heard."""
    left_s = [
        (history.experiment.run.moves - learning.number(made)) * t_s / made
        for robot in history.experiment.learners
        if (made := (learning := history.robots[robot.id].learning).made(t_s)) >= PACE_KNOWN_AFTER
    ]
    return round(max(0.0, *left_s), 1) if len(left_s) == len(history.experiment.learners) else None


def _robot(history: RunHistory, robot: RobotHistory, t_s: float, since_s: float) -> dict[str, Any]:
    status, made = newest(robot.statuses, t_s), robot.learning.made(t_s)
    best = newest(robot.learning.best_paths, t_s)
    said = {
        "activity": status.activity if status else "",
        "moves": max(robot.learning.number(made), status.moves if status else 0),
        "tracks": status.tracks if status else 0,
        "best": best.length if best else None,
        "action": move_under_way(robot, made, t_s),
        "path": path_under_way(robot, made, t_s),
        "visit": visit_under_way(history, robot, t_s),
        "rate_hz": round(robot.track.count(t_s - RATE_WINDOW_S, t_s) / min(RATE_WINDOW_S, max(t_s, 1.0)), 1),
        "battery_v": round(status.battery_v, 2) if status and status.battery_v else None,
        "bad": (status.bad_messages + status.failed_exchanges) if status else 0,
        "lost": robot.lost,
        "received": robot.received,
    }
    return {**_place(robot, t_s), **said, "trail": _trail(robot, t_s, since_s)}


def _place(robot: RobotHistory, t_s: float) -> dict[str, Any]:
    found = robot.track.at(t_s)
    if found is None:
        return {"pose": None, "pose_age_s": None, "cell": None}
    seen_s, pose = found
    return {
        "pose": [round(pose.x_m, 4), round(pose.y_m, 4), round(pose.theta_rad, 3)],
        "pose_age_s": round(t_s - seen_s, 1),
        "cell": robot.compartment.state_at(pose.x_m, pose.y_m),
    }


def _trail(robot: RobotHistory, t_s: float, since_s: float) -> list[list[float]]:
    places = robot.track.places(since_s, t_s, TRAIL_POINTS)
    return [[round(at_s, 2), round(x_m, 3), round(y_m, 3)] for at_s, x_m, y_m in places]


def visit_under_way(history: RunHistory, robot: RobotHistory, t_s: float) -> dict[str, Any] | None:
    """Whom the robot watches, since when, and where its camera found it if that was told."""
    visit = newest(robot.visits, t_s)
    if visit is None or visit.phase == "done":
        return None
    return {
        "number": visit.visit,
        "phase": visit.phase,
        "whom": robot.settings.watches,
        "since_s": round(visit.t_s, 1),
        "sighting": _sighting(history, robot, visit.visit, t_s) if visit.phase == "watching" else None,
    }


def _sighting(history: RunHistory, robot: RobotHistory, visit: int, t_s: float) -> list[float] | None:
    """Range and bearing of the newest camera frame, as the observer judged it; [] if it did not see it."""
    seen = next((entry.message for entry in robot.observations if entry.message.visit == visit), None)
    if seen is None:
        return None
    now_ns = history.began_ns + round(t_s * NS_PER_S)
    looks = [look for look in seen.looks if 0 <= now_ns - look.captured_t_ns < SIGHTING_HOLDS_S * NS_PER_S]
    if not looks:
        return None
    return [round(looks[-1].range_m, 3), round(looks[-1].bearing_rad, 4)] if looks[-1].range_m else []
