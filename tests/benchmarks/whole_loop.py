"""The whole loop in separate processes: an expert, a learner that watches it, and a learner that does not.

`python -m tests.benchmarks.whole_loop [--moves N]` runs deploy/sim/demo.toml, one robot a process, and prints
one JSON line: the real-time factor, and each process's CPU time a tick in microseconds, counted by the system
from its start to its end (importing included; `start_s` is what that takes, from a run of one move).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment
from tests.support.swarm_runs import ROOT, messages, server_command

EXPERIMENT = ROOT / "deploy" / "sim" / "demo.toml"
LEAST_REAL_TIME_FACTOR = 80.0


@dataclass(frozen=True)
class Run:
    """What one run took."""

    moves: int
    sim_s: float
    wall_s: float
    children_cpu_s: float
    digest: str
    visits: int
    paths: int
    wrong_paths: int


def run(moves: int) -> Run:
    """A run of the demo, timed from outside; all processes are children of the server."""
    with tempfile.TemporaryDirectory() as directory:
        out = Path(directory) / "run"
        before = os.times()
        command = server_command(EXPERIMENT, out, "--moves", str(moves))
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        after = os.times()
        result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        log = out / "trial-000.mcap"
        errors = [message.edit_distance for _, message in messages(log, "copy_error")]
        return Run(
            moves,
            result["sim_s"],
            result["wall_s"],
            after.children_user + after.children_system - before.children_user - before.children_system,
            result["digest"],
            sum(message.phase == message.DONE for _, message in messages(log, "visit")),
            sum(path.source == "camera" for _, path in messages(log, "path")),
            sum(error > 0 for error in errors),
        )


def measure(moves: int) -> dict[str, Any]:
    """A long run and one of a single move, whose difference is what ticks cost."""
    experiment = Experiment.load(EXPERIMENT)
    short, long = run(1), run(moves)
    sim_s, wall_s = long.sim_s - short.sim_s, long.wall_s - short.wall_s
    ticks = sim_s / experiment.simulation.tick_s
    processes = len(experiment.robot) + 2
    cpu_us = 1e6 * (long.children_cpu_s - short.children_cpu_s) / ticks
    factor = sim_s / wall_s
    return {
        "benchmark": "whole_loop",
        "real_time_factor": round(factor, 1),
        "real_time_factor_with_start": round(long.sim_s / long.wall_s, 1),
        "met": factor >= LEAST_REAL_TIME_FACTOR,
        "cpu_us_a_tick": round(cpu_us),
        "cpu_us_a_tick_and_process": round(cpu_us / processes),
        "cpu_bound_real_time_factor_on_2_cores": round(2e6 * experiment.simulation.tick_s / cpu_us, 1),
        "start_s": round(short.wall_s, 2),
        "load": [round(load, 2) for load in os.getloadavg()],
        "run": asdict(long),
        "python": sys.version.split()[0],
        "measured": time.strftime("%Y-%m-%d"),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=3000)
    print(json.dumps(measure(parser.parse_args().moves)))


if __name__ == "__main__":
    main()
