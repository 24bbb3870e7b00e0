"""Whether a laboratory can do what is asked of it: its names exist, and an experiment fits its robots."""

from __future__ import annotations

from collections.abc import Iterator

from swarm.checkup.finding import Finding, bad, good, warning
from swarm.config.experiment import Experiment, RobotSettings
from swarm.config.laboratory import Laboratory, RobotMachine
from swarm.config.toml_files import ConfigFile
from swarm.errors import UserError, nearest
from swarm.plugins import DRIVERS, TRACKERS, plugins

SAID_TWICE = ("driver", "address", "wheel_diameter_m", "wheel_base_m", "skirt", "south_west_m")
"""What an experiment says of a robot too. It is measured in the laboratory, so both must say the same."""


def laboratory_findings(laboratory: Laboratory) -> Iterator[Finding]:
    """About the laboratory alone. Places of findings are places in its file."""
    for number, robot in enumerate(laboratory.robot):
        yield _known(f"driver of {robot.id}", robot.driver, DRIVERS, ("robot", number, "driver"))
        if robot.calibration:
            yield _calibration(robot, number)
    if laboratory.tracker:
        yield _known("tracker", laboratory.tracker.backend, TRACKERS, ("tracker", "backend"))


def fit_findings(laboratory: Laboratory, experiment: Experiment) -> Iterator[Finding]:
    """About an experiment that is to run there."""
    for robot in experiment.robot:
        yield from _robot(laboratory, robot)
    taking_part = {robot.id for robot in experiment.robot}
    for number, idle in enumerate(laboratory.robot):
        if idle.id not in taking_part:
            text = "takes no part in the experiment"
            yield warning(f"robot {idle.id}", text, "its agent is not started", ("robot", number))
    if laboratory.tracker:
        yield _backend(laboratory.tracker.backend, experiment.tracker.backend)


def _known(about: str, name: str, group: str, key: tuple[str | int, ...]) -> Finding:
    known = plugins(group)
    return (
        good(about, name) if name in known else bad(about, f"{name!r} is unknown", nearest(name, known), key)
    )


def _calibration(robot: RobotMachine, number: int) -> Finding:
    about = f"calibration of {robot.id}"
    assert robot.calibration is not None
    try:
        ConfigFile(robot.calibration)
    except UserError as error:
        return bad(
            about, str(error), "make it with `robot-agent calibrate`", ("robot", number, "calibration")
        )
    return good(about, robot.calibration.name)


def _robot(laboratory: Laboratory, wanted: RobotSettings) -> Iterator[Finding]:
    known = [robot.id for robot in laboratory.robot]
    about = f"robot {wanted.id}"
    if wanted.id not in known:
        yield bad(about, "is in the experiment and not in the laboratory", nearest(wanted.id, known))
        return
    robot, where = laboratory.robot_named(wanted.id), ("robot", known.index(wanted.id))
    differing = [name for name in SAID_TWICE if getattr(robot, name) != getattr(wanted, name)]
    for name in differing:
        here, there = getattr(robot, name), getattr(wanted, name)
        text = f"{name} is {here!r} in the laboratory and {there!r} in the experiment"
        yield bad(about, text, "write the same in both", (*where, name))
    if not differing:
        yield good(about, f"{robot.driver}, {robot.skirt} skirt, on {robot.host}")


def _backend(here: str, there: str) -> Finding:
    if here == there:
        return good("tracker", f"{here}, as in the experiment")
    text = f"backend is {here!r} in the laboratory and {there!r} in the experiment"
    return bad("tracker", text, "write the same in both", ("tracker", "backend"))
