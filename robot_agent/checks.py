"""What has to be right before a robot starts: its driver, and what those need that watch others.

`swarm doctor` and the server find this by its place in `swarm.plugins`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from robot_agent.drivers.sim.rendering.colours import colour
from robot_agent.drivers.sim.rendering.conditions import conditions
from swarm.checkup.finding import Finding, Key, bad, good
from swarm.config.experiment import Experiment, RobotSettings
from swarm.errors import UserError, nearest
from swarm.plugins import DRIVERS, plugins

SIMULATED = "sim"
VISION = "pip install 'swarm-runtime[vision]', or on 32-bit ARM Debian's python3-opencv"


def checks(experiment: Experiment) -> Iterator[Finding]:
    """About all robots of an experiment."""
    return robot_checks(experiment, experiment.robot)


def robot_checks(experiment: Experiment, robots: tuple[RobotSettings, ...]) -> Iterator[Finding]:
    """About some of them, such as the one on this board."""
    for robot in robots:
        key = ("robot", experiment.robot.index(robot))
        yield _driver(robot, (*key, "driver"))
        if robot.driver == SIMULATED:
            yield _tried(f"skirt of {robot.id}", robot.skirt, colour, (*key, "skirt"))
            yield from _reflex(robot, (*key, "keep_off_m"))
    yield from _camera(experiment, robots)


def _driver(robot: RobotSettings, key: Key) -> Finding:
    about, known = f"driver of {robot.id}", plugins(DRIVERS)
    if robot.driver not in known:
        return bad(about, f"there is no driver {robot.driver!r}", nearest(robot.driver, known), key)
    return good(about, robot.driver)


def _reflex(robot: RobotSettings, key: Key) -> Iterator[Finding]:
    if robot.keep_off_m:
        text = "keep_off_m needs proximity sensors, which a simulated robot has not"
        yield bad(f"reflex of {robot.id}", text, "set it to 0, or leave it out", key)


def _camera(experiment: Experiment, robots: tuple[RobotSettings, ...]) -> Iterator[Finding]:
    """Also if nobody watches: who writes these settings means them."""
    camera = experiment.camera
    if any(robot.driver == SIMULATED for robot in robots):
        yield _tried("camera's light", camera.conditions, conditions, ("camera", "conditions"))
    if find_spec("cv2") is None:
        yield from _blind(experiment, robots)
        return
    if camera.calibration:
        from robot_agent.vision.camera_model import load_calibration

        yield _tried_file("camera's calibration", camera.calibration, load_calibration, "calibration")
    if camera.colours:
        from robot_agent.vision.colour_table import load_colour_table

        load = partial(load_colour_table, gamma=1.0)  # whether it can be read does not depend on it
        yield _tried_file("camera's colours", camera.colours, load, "colours")


def _blind(experiment: Experiment, robots: tuple[RobotSettings, ...]) -> Iterator[Finding]:
    """Without OpenCV nobody can watch; whoever does not needs none."""
    for robot in robots:
        if robot.watches:
            key = ("robot", experiment.robot.index(robot), "watches")
            yield bad(f"sight of {robot.id}", f"to watch {robot.watches!r} it needs cv2", VISION, key)


def _tried_file(about: str, file: str, load: Callable[[Path], object], key: str) -> Finding:
    return _tried(about, file, lambda name: load(Path(name)), ("camera", key))


def _tried(about: str, name: str, use: Callable[[str], object], key: Key) -> Finding:
    """What using a setting would say."""
    try:
        use(name)
    except UserError as error:
        return bad(about, str(error), "", key)
    return good(about, name)
