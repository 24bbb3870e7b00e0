"""Which processes a simulated trial consists of: one line each."""

from __future__ import annotations

import socket
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from server.processes.supervisor import ProcessSpec
from swarm.config.experiment import REAL_LINKS, Experiment


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
    experiment: Experiment,
    file: Path,
    endpoint: str,
    trial: int,
    pace: Pace,
    output: Path,
    emulated: Mapping[str, str] | None = None,
) -> list[ProcessSpec]:
    """The tracker bridge, the emulator if robots are `emulated` (addresses by id), and the robots divided
    over the experiment's number of processes.

    The processes of robots leave an account of all that they received (`output`/PROCESS.keys).
    """
    run = experiment.run
    changed = ("--seed", str(run.seed), "--moves", str(run.moves), "--trial", str(trial), "--supervised")
    common = (str(file), "--connect", endpoint, *changed, *pace.arguments())
    specs = [ProcessSpec("tracker", "tracker_bridge", (*common, "--process", "tracker"))]
    at = [f"--address={robot}={address}" for robot, address in (emulated or {}).items()]
    if at:
        arguments = ("emulate-robots", *common, "--process", "emulator", *at)
        specs.append(ProcessSpec("emulator", "robot_agent", arguments))
    for number, names in enumerate(_divided(experiment)):
        process = f"robots-{number}"
        heard = ("--keys", str(output / f"{process}.keys"))
        arguments = (*common, "--process", process, "--robot", ",".join(names), *heard, *at)
        specs.append(ProcessSpec(process, "robot_agent", arguments))
    return specs


def emulated_addresses(experiment: Experiment, place: Path) -> dict[str, str]:
    """An address on this machine for every robot whose driver is a real link."""
    return {
        robot.id: _emulated_address(robot.driver, place / robot.id)
        for robot in experiment.robot
        if robot.driver in REAL_LINKS
    }


def _emulated_address(link: str, file: Path) -> str:
    """A file in the place of a serial port, a socket in that of a bus, a port that is free now for Wi-Fi."""
    if link != "wifi":
        return str(file) if link == "serial" else f"unix:{file}"
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return f"127.0.0.1:{probe.getsockname()[1]}"


def _divided(experiment: Experiment) -> list[list[str]]:
    """The robots' ids by process, as evenly as their number allows."""
    names = [robot.id for robot in experiment.robot]
    count = min(experiment.simulation.processes or len(names), len(names))
    return [names[number::count] for number in range(count)]
