"""What no single value of an experiment file shows: ids, who watches whom, compartments that overlap."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from swarm.config.ids import check_id, check_robot_id
from swarm.config.limits import BEYOND_CORNER_M, MOST_FRAMES
from swarm.config.toml_files import ConfigFile
from swarm.errors import nearest

if TYPE_CHECKING:
    from swarm.config.experiment import Experiment, RobotSettings

SECONDS_PER_HOUR = 3600


def check_consistency(experiment: Experiment, file: ConfigFile) -> None:
    """UserError, with its line in the file, about what no single value shows."""
    check_id(experiment.run.name, ("run", "name"), file)
    if not experiment.learners:
        raise file.error(("robot", 0, "role"), "no robot is a learner: there is nothing to learn or to plot")
    _check_blackouts(experiment, file)
    for number, robot in enumerate(experiment.robot):
        _check_robot(experiment, number, robot, file)


def _check_blackouts(experiment: Experiment, file: ConfigFile) -> None:
    tracker = experiment.tracker
    if tracker.blackouts_per_hour * tracker.blackout_s > SECONDS_PER_HOUR:
        raise file.error(
            ("tracker", "blackout_s"),
            f"{tracker.blackouts_per_hour:g} losses an hour of {tracker.blackout_s:g} s each are more than "
            "the hour: a robot would be seen for hardly a moment; make them fewer or shorter",
        )


def _check_robot(experiment: Experiment, number: int, robot: RobotSettings, file: ConfigFile) -> None:
    where = ("robot", number)
    check_robot_id(robot.id, (*where, "id"), file)
    check_id(robot.group, (*where, "condition"), file)
    if robot.paths and robot not in experiment.learners:
        raise file.error((*where, "paths"), f"{robot.id!r} is no learner: it cannot be given paths")
    if len(robot.paths) > experiment.learning.capacity:
        raise file.error((*where, "paths"), f"{len(robot.paths)} paths do not fit in [learning] capacity")
    try:
        robot.given_paths()
    except ValueError as error:
        raise file.error((*where, "paths"), str(error)) from error
    _check_watching(experiment, number, robot, file)
    _check_access(experiment, number, robot, file)
    _check_place(experiment, number, robot, file)


def _check_watching(experiment: Experiment, number: int, robot: RobotSettings, file: ConfigFile) -> None:
    where = ("robot", number, "watches")
    known = [other.id for other in experiment.robot if other.id != robot.id]
    if robot.watches and robot not in experiment.learners:
        raise file.error(where, f"{robot.id!r} is no learner: it cannot watch")
    if robot.watches and robot.watches not in known:
        whom = nearest(robot.watches, known) if known else "there is no other robot"
        raise file.error(where, f"{robot.id!r} watches {robot.watches!r}; {whom}")
    if robot.watches:
        _check_observers_place(experiment, robot, file)
        _check_frames(experiment, file)


def _check_access(experiment: Experiment, number: int, robot: RobotSettings, file: ConfigFile) -> None:
    where = ("robot", number, "accesses")
    known = [other.id for other in experiment.learners if other.id != robot.id]
    if robot.accesses and robot not in experiment.learners:
        raise file.error(where, f"{robot.id!r} is no learner: it has no use for another's internal state")
    if robot.accesses and robot.accesses not in known:
        whom = nearest(robot.accesses, known) if known else "there is no other learner"
        raise file.error(where, f"{robot.id!r} accesses {robot.accesses!r}, which is no learner; {whom}")


def _check_observers_place(experiment: Experiment, robot: RobotSettings, file: ConfigFile) -> None:
    demonstrator, arena = experiment.robot_named(robot.watches), experiment.arena
    place = experiment.observers_place(demonstrator)
    if not (0 <= place.x_m <= arena.width_m and 0 <= place.y_m <= arena.height_m):
        where = ("robot", experiment.robot.index(demonstrator), "south_west_m")
        raise file.error(
            where,
            f"{robot.id!r} would watch {robot.watches!r} from ({place.x_m:.2f}, {place.y_m:.2f}) m, which is "
            f"off the floor: leave {BEYOND_CORNER_M:g} m east and south of that compartment",
        )


def _check_frames(experiment: Experiment, file: ConfigFile) -> None:
    visits = experiment.visits
    frames = math.ceil(visits.duration_s * visits.frames_per_s)
    if frames > MOST_FRAMES:
        raise file.error(
            ("visits", "duration_s"),
            f"{visits.duration_s:g} s at {visits.frames_per_s:g} frames a second are {frames} frames of a "
            f"visit, which holds at most {MOST_FRAMES}: watch for less long, or look less often",
        )


def _check_place(experiment: Experiment, number: int, robot: RobotSettings, file: ConfigFile) -> None:
    where = ("robot", number, "south_west_m")
    place, arena = experiment.compartment(robot), experiment.arena
    slack_m = 1e-9
    if (
        min(place.west_m, place.south_m) < -slack_m
        or place.east_m > arena.width_m + slack_m
        or place.north_m > arena.height_m + slack_m
    ):
        size = f"{arena.width_m:g} x {arena.height_m:g} m"
        raise file.error(where, f"the compartment of {robot.id!r} reaches out of the arena of {size}")
    for other in experiment.robot[:number]:
        if other.id == robot.id:
            raise file.error(("robot", number, "id"), f"two robots are called {robot.id!r}")
        if place.overlaps(experiment.compartment(other)):
            raise file.error(where, f"the compartments of {other.id!r} and {robot.id!r} overlap")
