"""What one learner has in its head at a moment, and where a path of its memory came from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from swarm.clock import NS_PER_S
from swarm.console.learning_history import PathCounts
from swarm.console.robot_history import RobotHistory
from swarm.console.run_history import RunHistory
from swarm.geometry import Move, Pose

HEADING_WITHIN_S = 0.3
"""Seven poses at 10 Hz: 0.6 degrees of noise become 0.25, and a robot that watches turns slowly."""
RATIO_POINTS = 150
"""Of R over time: as many as a small plot has pixels."""

T = TypeVar("T")


def learner_view(history: RunHistory, name: str, t_s: float) -> dict[str, Any]:
    """The Q-table, state by state, and every path of the memory with its R, p_imitate and R over time."""
    robot = history.robots[name]
    made = robot.learning.made(t_s)
    return {
        "kind": "learner",
        "robot": name,
        "moves": robot.learning.number(made),
        "first": robot.learning.number(1) if made else 0,
        "q_table": [round(value, 4) for value in robot.learning.q_table(made)],
        "memory": [_path(history, robot, counts) for counts in robot.learning.memory(t_s)],
    }


def _path(history: RunHistory, robot: RobotHistory, counts: PathCounts) -> dict[str, Any]:
    path = counts.path
    copied = _copy_error(robot, path.visit) if path.visit else None
    return {
        "number": path.number,
        "moves": [Move(move).name for move in path.moves],
        "source": path.source,
        "visit": path.visit,
        "remembered_s": round(path.t_s, 1),
        "wrong": copied,
        "replayed": counts.replayed,
        "completed": counts.completed,
        "improved": counts.improved,
        "ratio": round(counts.ratio, 4),
        "p_imitate": round(history.experiment.learning.beta * counts.ratio, 4),
        "ratios": thinned([[move, round(ratio, 3)] for move, ratio in counts.ratios], RATIO_POINTS),
    }


def _copy_error(robot: RobotHistory, visit: int) -> int | None:
    """By how many edits the copied moves differ from the demonstrator's real ones, once the server knows."""
    found = [entry.message for entry in robot.copy_errors if entry.message.visit == visit]
    return found[-1].edit_distance if found else None


def observation_view(history: RunHistory, name: str, visit: int) -> dict[str, Any] | None:
    """The ledger of a visit: each frame's sighting beside where the demonstrator was by its own tracker,
    and how the places became moves; None if the robot told of no such visit.
    """
    robot = history.robots[name]
    seen = next((entry.message for entry in robot.observations if entry.message.visit == visit), None)
    if seen is None:
        return None
    errors = [entry.message for entry in robot.copy_errors if entry.message.visit == visit]
    return {
        "kind": "observation",
        "robot": name,
        "visit": visit,
        "whom": robot.settings.watches,
        "profile": seen.profile,
        "reason": seen.reason,
        "looks": [_look(history, robot, look) for look in seen.looks],
        "smoothed": [[round(place.x_m, 3), round(place.y_m, 3)] for place in seen.smoothed],
        "moves": [Move(move).name for move in seen.moves],
        "confidences": [round(value, 2) for value in seen.confidences],
        "window": [Move(move).name for move in seen.window],
        "true_moves": [Move(move).name for move in errors[-1].true_moves] if errors else None,
        "edit_distance": errors[-1].edit_distance if errors else None,
    }


def _look(history: RunHistory, robot: RobotHistory, look: Any) -> dict[str, Any]:
    t_s = (look.captured_t_ns - history.began_ns) / NS_PER_S
    demonstrator = history.robots.get(robot.settings.watches)
    own, other = robot.track.between(t_s), demonstrator.track.between(t_s) if demonstrator else None
    heading_rad = robot.track.heading_about(t_s, HEADING_WITHIN_S)
    own = Pose(own.x_m, own.y_m, heading_rad) if own and heading_rad is not None else own
    return {
        "t_s": round(t_s, 2),
        "hash": f"{look.frame_hash:016x}",
        "seen": [round(look.x_m, 3), round(look.y_m, 3)] if look.range_m else None,
        "range_m": round(look.range_m, 3),
        "bearing_rad": round(look.bearing_rad, 4),
        "why_not": look.not_seen,
        "own": _rounded(own) if own else None,
        "tracked": _rounded(other) if other else None,
    }


def _rounded(pose: Pose) -> list[float]:
    return [round(pose.x_m, 3), round(pose.y_m, 3), round(pose.theta_rad, 3)]


def thinned(entries: Sequence[T], at_most: int) -> list[T]:
    """Evenly chosen entries, the last one among them."""
    step = max(1, -(-len(entries) // at_most))
    return list(entries[::-1][::step])[::-1]
