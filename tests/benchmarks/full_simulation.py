"""How fast the full simulation is, and where its time goes.

Runs `swarm-server` in this process and its robots in others: 3 robots in 3 processes, and 50 in 2. Beside
the real-time factor it prints each process's CPU time per tick, which another user of the machine does not
change. `python -m tests.benchmarks.full_simulation` prints one JSON line.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from pathlib import Path
from typing import Any

from rich.console import Console

from server.conductor.conductor import Conductor
from server.processes.environment import simulated
from server.progress import RunProgress
from server.run import Run
from server.run_directory import RunDirectory
from swarm.config.experiment import Experiment
from tests.benchmarks.processes import cpu_of
from tests.support.swarm_runs import experiment_text, learners, write_experiment

TICK_S = 0.1


class Watch(RunProgress):
    """Looks at the clocks whenever the run shows its progress."""

    def __init__(self, experiment: Experiment, console: Console) -> None:
        super().__init__(experiment, console)
        self.looks: list[tuple[float, float, dict[str, float]]] = []
        """Simulated time, wall time, CPU time by process."""

    def show(self, conductor: Conductor, t_s: float) -> None:
        self.looks.append((t_s, time.perf_counter(), cpu_of(_processes())))
        super().show(conductor, t_s)


def _processes() -> dict[str, int]:
    """This process and the children that have a name."""
    found = {"server": os.getpid()}
    for task in Path("/proc/self/task").iterdir():
        for pid in (task / "children").read_text().split():
            words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
            if "--process" in words:
                found[words[words.index("--process") + 1]] = int(pid)
    return found


def measure(robots: int, processes: int, moves: int, ticks_per_exchange: int = 2) -> dict[str, Any]:
    """A run's speed between its first and last look."""
    with tempfile.TemporaryDirectory() as directory:
        simulation = f"[simulation]\nprocesses = {processes}\nticks_per_exchange = {ticks_per_exchange}"
        text = experiment_text(learners(robots), moves, simulation)
        file = write_experiment(Path(directory), text)
        experiment = Experiment.load(file)
        watch = Watch(experiment, Console(stderr=True, quiet=True))
        run_directory = RunDirectory.create(Path(directory) / "run", experiment.run.name)
        Run(experiment, file, run_directory, simulated(experiment, None, watch.warn), [0], watch).run()
    (t0_s, wall0_s, cpu0), (t1_s, wall1_s, cpu1) = watch.looks[0], watch.looks[-1]
    ticks = (t1_s - t0_s) / TICK_S
    used = {name: 1e6 * (cpu1[name] - cpu0[name]) / ticks for name in cpu1}
    best = max(
        (later[0] - sooner[0]) / (later[1] - sooner[1])
        for sooner, later in zip(watch.looks, watch.looks[1:], strict=False)
    )
    return {
        "robots": robots,
        "processes": processes,
        "ticks_per_exchange": ticks_per_exchange,
        "ticks": round(ticks),
        "real_time_factor": round((t1_s - t0_s) / (wall1_s - wall0_s), 1),
        "real_time_factor_best_1000_ticks": round(best, 1),
        "robot_ticks_per_s": round(robots * ticks / (wall1_s - wall0_s)),
        "robot_ticks_per_s_best_1000_ticks": round(robots * best / TICK_S),
        "cpu_us_per_tick": {name: round(value, 1) for name, value in used.items()},
        "cpu_us_per_robot_tick": round(sum(used.values()) / robots, 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, nargs=2, default=(300, 100), help="for 3 and for 50 robots")
    arguments = parser.parse_args()
    few, many = arguments.moves
    figures = {
        "three": measure(3, 3, 2 * few),
        "three_with_one_tick_an_exchange": measure(3, 3, few, ticks_per_exchange=1),
        "fifty": measure(50, 2, many),
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
