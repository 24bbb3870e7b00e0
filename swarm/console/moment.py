"""What can be said of a run at one moment: where every robot is, what it does, how it is."""

from __future__ import annotations

from typing import Any

from swarm.clock import NS_PER_S
from swarm.console.robot_history import RobotHistory, newest, place_at
from swarm.console.run_history import RunHistory

TRAIL_POINTS = 24
"""Of one robot between two frames: a second of poses at 20 Hz."""
RATE_WINDOW_S = 10.0
"""A hundred poses: a lost one shows as 1 %."""
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
    """Until the slowest learner has made its moves at its pace so far; None before its tenth move."""
    made = min(history.robots[robot.id].learning.made(t_s) for robot in history.experiment.learners)
    if made < 10:
        return None
    return round(max(0, history.experiment.run.moves - made) * t_s / made, 1)


def _robot(history: RunHistory, robot: RobotHistory, t_s: float, since_s: float) -> dict[str, Any]:
    status, made = newest(robot.statuses, t_s), robot.learning.made(t_s)
    best = newest(robot.learning.best_paths, t_s)
    said = {
        "activity": status.activity if status else "",
        "moves": max(made, status.moves if status else 0),
        "tracks": status.tracks if status else 0,
        "best": best.length if best else None,
        "action": _action(robot, made, t_s),
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


def _action(robot: RobotHistory, made: int, t_s: float) -> list[int] | None:
    """The cell and the action of the move that is being made; known once it was told of."""
    moves = robot.learning.moves
    if made < len(moves) and moves[made].t_s - moves[made].duration_s <= t_s:
        return [moves[made].state, moves[made].action]
    return None


def path_under_way(robot: RobotHistory, made: int, t_s: float) -> dict[str, Any] | None:
    """The path that is being enacted: its number, moves, first cell, and how many of its moves are made."""
    learning = robot.learning
    place = made if made < len(learning.moves) and _action(robot, made, t_s) else made - 1
    if place < 0 or not learning.moves[place].path:
        return None
    move = learning.moves[place]
    ended = learning.replays[: place_at(learning.replays, t_s)][-2:]
    if place < made and any(
        each.path == move.path and each.started_move <= move.number < each.started_move + each.moves
        for each in ended
    ):
        return None
    first = _first_of_replay(robot, place)
    path = next((path for path in learning.paths if path.number == move.path), None)
    return {
        "number": move.path,
        "moves": list(path.moves) if path else [],
        "from": learning.moves[first].state,
        "done": made - first,
    }


def _first_of_replay(robot: RobotHistory, place: int) -> int:
    """The place of the first move of the replay that a move belongs to: two may follow each other."""
    learning = robot.learning
    move = learning.moves[place]
    before = newest(learning.replays, learning.moves[place - 1].t_s if place else 0.0)
    begins = before.started_move + before.moves if before else 1
    first = place
    while (
        first and learning.moves[first - 1].path == move.path and learning.moves[first - 1].number >= begins
    ):
        first -= 1
    return first


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
