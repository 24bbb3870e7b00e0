"""How exactly robots replicate patterns that they saw, behind each link.

`python -m tests.benchmarks.replication` prints one JSON line: mean and worst corner error of random
five-segment patterns, by the simulated truth.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np

from robot_agent.imitation.copying import NoCopy
from robot_agent.imitation.pattern import corner_error_m
from swarm.config.experiment import CopyProfile
from swarm.learning.random import spawned_generator
from tests.support.imitating_pair import Imitated, ImitatingPair, random_pattern

PAIRS = (("serial", "wifi"), ("wifi", "serial"), ("serial", "i2c"), ("wifi", "spi-epuck1"), ("sim", "sim"))
"""Demonstrator and observer."""
SEGMENTS = 5


def imitated(pair: tuple[str, str], profile: CopyProfile, number: int, *, tracked: bool) -> Imitated:
    rng = spawned_generator(1, "replication", number, "pattern", profile.value)
    commands, _ = random_pattern(rng, SEGMENTS)
    with tempfile.TemporaryDirectory() as place:
        robots = ImitatingPair(*pair, Path(place), rng, profile, tracked=tracked)
        try:
            return robots.imitated(commands)
        finally:
            robots.close()


def figures(pair: tuple[str, str], profile: CopyProfile, count: int, *, tracked: bool) -> dict[str, object]:
    results = [imitated(pair, profile, number, tracked=tracked) for number in range(count)]
    errors_cm = [100 * corner_error_m(each.shown, each.driven) for each in results if each.driven]
    driven = [each.result for each in results if not isinstance(each.result, NoCopy)]
    return {
        "patterns": count,
        "refused": count - len(driven),
        "other_number_of_segments": sum(len(result.segments) != SEGMENTS for result in driven),
        "mean_corner_error_cm": round(float(np.mean(errors_cm)), 2) if errors_cm else None,
        "worst_pattern_cm": round(max(errors_cm), 2) if errors_cm else None,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--patterns", type=int, default=10)
    count = parser.parse_args().patterns
    best = CopyProfile.BEST
    table = {"-".join(pair): figures(pair, best, count, tracked=True) for pair in PAIRS}
    table["sim, profile paper"] = figures(("sim", "sim"), CopyProfile.PAPER, count, tracked=True)
    print(json.dumps({"benchmark": "replication", "figures": table}))


if __name__ == "__main__":
    main()
