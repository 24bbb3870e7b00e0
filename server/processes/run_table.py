"""Which processes a simulated trial consists of: one line each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from server.processes.supervisor import ProcessSpec
from swarm.config.experiment import Experiment


@dataclass(frozen=True)
class Pace:
    """How time passes: lockstep, or `speed` times real time since a monotonic time."""

    lockstep: bool
    speed: float = 1.0
    started_ns: int = 0

    def arguments(self) -> tuple[str, ...]:
        if self.lockstep:
            return ("--lockstep",)
        return ("--started-ns", str(self.started_ns), "--speed", str(self.speed))


def run_table(
    experiment: Experiment, file: Path, endpoint: str, trial: int, pace: Pace, output: Path
) -> list[ProcessSpec]:
    """The tracker bridge, and the robots divided over the experiment's number of processes.

    The processes of robots leave a list of all keys that they received (`output`/PROCESS.keys).
    """
    run = experiment.run
    changed = ("--seed", str(run.seed), "--moves", str(run.moves), "--trial", str(trial))
    common = (str(file), "--connect", endpoint, *changed, *pace.arguments())
    specs = [ProcessSpec("tracker", "tracker_bridge", (*common, "--process", "tracker"))]
    for number, names in enumerate(_divided(experiment)):
        process = f"robots-{number}"
        heard = ("--keys", str(output / f"{process}.keys"))
        arguments = (*common, "--process", process, "--robot", ",".join(names), *heard)
        specs.append(ProcessSpec(process, "robot_agent", arguments))
    return specs


def _divided(experiment: Experiment) -> list[list[str]]:
    """The robots' ids by process, as evenly as their number allows."""
    names = [robot.id for robot in experiment.robot]
    count = min(experiment.simulation.processes or len(names), len(names))
    return [names[number::count] for number in range(count)]
