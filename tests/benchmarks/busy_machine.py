"""How much of its quiet speed a simulated swarm keeps when something else wants the cores.

Three learners in three processes run alone, beside two processes that only count, and beside another such
swarm, in turn, so that whatever else the machine does is as bad for each.
`python -m tests.benchmarks.busy_machine [--rounds N] [--moves N]` prints one JSON line: real-time factors and
the medians' ratios to the quiet speed.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from tests.support.swarm_runs import experiment_text, learners, server_command, write_experiment

COUNT = "while True: pass"
SPINNERS = 2
"""As many as the smallest machine that this is meant for has cores."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--moves", type=int, default=400)
    arguments = parser.parse_args()
    factors: dict[str, list[float]] = {"quiet": [], "beside_two_counters": [], "beside_another_swarm": []}
    for _ in range(arguments.rounds):
        with tempfile.TemporaryDirectory() as folder:
            file = write_experiment(Path(folder), experiment_text(learners(3), arguments.moves))
            factors["quiet"] += _side_by_side(file, Path(folder) / "quiet", 1)
            with _counters(SPINNERS):
                factors["beside_two_counters"] += _side_by_side(file, Path(folder) / "busy", 1)
            factors["beside_another_swarm"] += _side_by_side(file, Path(folder) / "two", 2)
    middle = {name: median(values) for name, values in factors.items()}
    ratios = {name: round(value / middle["quiet"], 2) for name, value in middle.items()}
    print(json.dumps({"real_time_factors": factors, "ratio_to_quiet": ratios}))


def _side_by_side(experiment: Path, out: Path, swarms: int) -> list[float]:
    """The real-time factors of so many runs at once."""
    running = [_started(experiment, out.with_name(f"{out.name}-{number}")) for number in range(swarms)]
    results = [json.loads(process.communicate()[0].splitlines()[-1]) for process in running]
    return [result["real_time_factor"] for result in results]


def _started(experiment: Path, out: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(server_command(experiment, out), stdout=subprocess.PIPE, text=True)


@contextmanager
def _counters(count: int) -> Iterator[None]:
    """Processes that want all of a core each."""
    counters = [subprocess.Popen([sys.executable, "-c", COUNT]) for _ in range(count)]
    try:
        yield
    finally:
        for counter in counters:
            counter.kill()
            counter.wait()


if __name__ == "__main__":
    main()
