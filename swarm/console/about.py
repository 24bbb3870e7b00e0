"""What stands still in a run: the arena, the robots, the rules, the plan."""

from __future__ import annotations

from typing import Any

from swarm.config.experiment import RobotSettings
from swarm.console.cures import CURES
from swarm.console.run_history import RunHistory


def about_run(history: RunHistory) -> dict[str, Any]:
    """Everything that a page needs to know once."""
    experiment, about = history.experiment, history.about
    arena, learning, visits = experiment.arena, experiment.learning, experiment.visits
    return {
        "kind": "about",
        "name": experiment.run.name,
        "source": about.source,
        "trial": about.trial,
        "trials": experiment.run.trials,
        "seed": experiment.run.seed,
        "moves": experiment.run.moves,
        "commit": about.commit,
        "run_id": about.run_id,
        "arena": {
            "width_m": arena.width_m,
            "height_m": arena.height_m,
            "cell_m": arena.cell_m,
            "columns": arena.columns,
            "rows": arena.rows,
        },
        "learning": {
            "epsilon": learning.epsilon,
            "beta": learning.beta,
            "capacity": learning.capacity,
            "cap": learning.path_length_cap,
        },
        "visits": {"every_tracks": visits.every_tracks, "duration_s": visits.duration_s},
        "shortest": max(arena.columns, arena.rows) - 1,
        "pose_rate_hz": experiment.tracker.rate_hz,
        "robots": [_robot(history, robot) for robot in experiment.robot],
        "cures": CURES,
    }


def _robot(history: RunHistory, robot: RobotSettings) -> dict[str, Any]:
    place = history.experiment.compartment(robot)
    watched = any(other.watches == robot.id for other in history.experiment.robot)
    return {
        "id": robot.id,
        "role": robot.role.value,
        "condition": robot.group,
        "watches": robot.watches,
        "skirt": robot.skirt if watched else "",
        "west_m": place.west_m,
        "south_m": place.south_m,
        "east_m": place.east_m,
        "north_m": place.north_m,
    }
