"""A run's control for tests in which nobody, or the test, gives orders."""

from __future__ import annotations

from server.conductor.prompts import Prompts
from server.conductor.run_control import RunControl
from server.reporter import Reporter
from swarm.config.experiment import Experiment
from swarm.runtime.emergency_latch import EmergencyLatch


def control_of(experiment: Experiment, reporter: Reporter) -> RunControl:
    """Of all the experiment's robots, which have not said where they are."""
    robots = [robot.id for robot in experiment.robot]
    return RunControl(robots, reporter, EmergencyLatch(None), Prompts(), lambda robot: None)  # noqa: ARG005
