"""How well, and how fast, demonstrations are copied: `python -m tests.benchmarks.copying`.

Prints one JSON line: for random and for expert demonstrations at five frames a second, and for each range
noise k (per centimetre), the share of perfect lists with its 95 % interval, the mean edit distance, and the
thread-CPU time of a copy; and whether the bars of the random demonstrations are met.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from robot_agent.imitation.copying import NoCopy, copy_moves
from swarm.config.experiment import CopyProfile
from swarm.geometry import Move
from swarm.learning.alignment import edit_distance
from tests.support.demonstrations import (
    COMPARTMENT,
    OUTSIDE_CORNER,
    Conditions,
    Demonstration,
    demonstration,
    expert_moves,
    random_moves,
)

CHOOSE_MOVES: dict[str, Callable[[np.random.Generator], tuple[int, tuple[Move, ...]]]] = {
    "random": random_moves,
    "expert": expert_moves,
}
BARS = {1.5e-4: (0.98, 0.03), 3e-4: (0.85, 0.20), 6e-4: (0.60, 0.80)}
"""k per centimetre -> least share of perfect lists, most mean edit distance."""
MOST_MS = 20.0


@dataclass(frozen=True)
class Score:
    """What came of many copies."""

    demonstrations: int
    perfect: float
    perfect_ci95: float
    edit_mean: float
    not_copied: int
    cpu_ms_mean: float
    cpu_ms_max: float


def demonstrations(kind: str, conditions: Conditions, count: int, seed: int) -> list[Demonstration]:
    """The same moves, routes and frame times for the same seed, whatever the noise."""
    generators = [np.random.default_rng([seed, number]) for number in range(count)]
    return [demonstration(rng, *CHOOSE_MOVES[kind](rng), conditions) for rng in generators]


def score(shown: Sequence[Demonstration], profile: CopyProfile) -> Score:
    """Copy every demonstration and compare with the true moves; no copy counts as an empty list.

    One copy that is not timed goes before, since the very first one loads parts of numpy.
    """
    copy_moves(shown[0].positions, profile, COMPARTMENT.cell_m, shown[0].expected_frames)
    edits, times_ms, not_copied = [], [], 0
    for each in shown:
        start_s = time.thread_time()
        copied = copy_moves(each.positions, profile, COMPARTMENT.cell_m, each.expected_frames)
        times_ms.append(1e3 * (time.thread_time() - start_s))
        not_copied += isinstance(copied, NoCopy)
        edits.append(edit_distance(each.moves, () if isinstance(copied, NoCopy) else copied.path().moves))
    perfect = edits.count(0) / len(edits)
    interval = 1.96 * math.sqrt(perfect * (1 - perfect) / len(edits))
    return Score(
        len(edits),
        round(perfect, 4),
        round(interval, 4),
        round(float(np.mean(edits)), 4),
        not_copied,
        round(float(np.mean(times_ms)), 2),
        round(max(times_ms), 2),
    )


def meets(scored: Score, bar: tuple[float, float]) -> bool:
    return scored.perfect >= bar[0] and scored.edit_mean <= bar[1] and scored.cpu_ms_mean < MOST_MS


def run(count: int, seed: int) -> dict[str, object]:
    """Both profiles on both kinds of demonstration, and `best` with the observer outside the corner."""
    results: dict[str, object] = {}
    met = []
    for k_per_cm, bar in BARS.items():
        conditions = Conditions(range_noise_per_m=100 * k_per_cm)
        for kind in CHOOSE_MOVES:
            shown = demonstrations(kind, conditions, count, seed)
            best = score(shown, CopyProfile.BEST)
            results[f"best/{kind}/{k_per_cm:g}"] = asdict(best)
            results[f"paper/{kind}/{k_per_cm:g}"] = asdict(score(shown, CopyProfile.PAPER))
            met += [meets(best, bar)] if kind == "random" else []
        outside = demonstrations("random", replace(conditions, observer=OUTSIDE_CORNER), count, seed)
        results[f"best/random, observer outside/{k_per_cm:g}"] = asdict(score(outside, CopyProfile.BEST))
    return {"benchmark": "copying", "seed": seed, "bars_met": all(met), "results": results}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(json.dumps(run(arguments.demonstrations, arguments.seed)))


if __name__ == "__main__":
    main()
