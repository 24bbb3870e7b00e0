"""How often the claims' tests find what is not there, and what is: level, power and coverage.

Null samples are drawn from one pool of runs without imitation, 100 pairs of curves with 200 points as in a
judged claim; an effect is made by giving one side more time: its curve at t is the other's at t times a pace.
Prints one JSON line.

    python -m tests.benchmarks.verdicts [--pool 1000] [--repetitions 1000] [--flips 1000]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from typing import Any

import numpy as np

from swarm.gridworld.condition import Condition
from swarm.gridworld.simulation import simulate
from swarm.learning.memory import Approach
from swarm.paper.conditions import NOT_BENEFICIAL, SMALL_NO_IMITATION, one_path, shortened
from swarm.statistics.last_difference import last_difference
from swarm.statistics.paired_tests import LEVEL, max_t_test, pointwise_t_test
from swarm.statistics.samples import Curves, FloatArray, Sample, mean_level
from swarm.statistics.sizes import above, equivalent

STEPS, PAIRS = 20_000, 100
"""Of the paper's figures."""
PACES = (1.0, 1.02, 1.05, 1.1, 1.2)
"""How much faster the better side learns."""
SIZES = (30, 100)
"""Runs whose "until" is bootstrapped."""
UNTIL_SAMPLES = 300
"""Each takes a thousand resamples."""


def pool(condition: Condition, runs: int) -> FloatArray:
    """Best path lengths (runs, 200) of a condition cut to the figures' time."""
    cut = shortened(condition, STEPS)
    rows = [simulate(cut, 1, run).best_path_length[0][9::10] for run in range(runs)]
    return np.array(rows, dtype=np.float64)


def curves(values: FloatArray) -> Curves:
    return Curves("drawn", np.arange(100.0, STEPS + 1, 100.0), values, tuple(range(len(values))))


def rejections(
    everyone: FloatArray, rng: np.random.Generator, flips: int, better: Callable[[FloatArray], FloatArray]
) -> dict[str, bool]:
    """What each test says of 100 pairs of which one side is made better."""
    drawn = everyone[rng.permutation(len(everyone))]
    one, other = curves(better(drawn[:PAIRS])), curves(drawn[PAIRS : 2 * PAIRS])
    family_wise = max_t_test(other, one, rng, flips)
    level = max_t_test(_single(mean_level(other)), _single(mean_level(one)), rng, flips)
    return {
        "paper, at some point": bool((pointwise_t_test(other, one).p <= LEVEL).any()),
        "family-wise": family_wise.smallest_p <= LEVEL,
        "mean over the curve": level.smallest_p <= LEVEL,
        "size, one-sided": above(mean_level(other), mean_level(one)).p <= LEVEL,
        "equivalence, margin 1 move": equivalent(mean_level(other), mean_level(one), 1.0).p <= LEVEL,
    }


def at_the_margin(everyone: FloatArray, rng: np.random.Generator) -> bool:
    """Whether two that differ by exactly the margin are called the same."""
    drawn = mean_level(curves(everyone[rng.permutation(len(everyone))[: 2 * PAIRS]])).values
    one = Sample("one", drawn[:PAIRS] + 1.0, tuple(range(PAIRS)))
    return equivalent(one, Sample("other", drawn[PAIRS:], tuple(range(PAIRS))), 1.0).p <= LEVEL


def pairs_of_learners(everyone: FloatArray, rng: np.random.Generator, flips: int) -> dict[str, bool]:
    """The mean of two learners against the mean of two, and against one."""
    drawn = everyone[rng.permutation(len(everyone))[: 4 * PAIRS]].reshape(4, PAIRS, -1)
    pair = curves(drawn[:2].mean(axis=0))
    return {
        "pair against pair": max_t_test(pair, curves(drawn[2:].mean(axis=0)), rng, flips).smallest_p <= LEVEL,
        "pair against single": max_t_test(pair, curves(drawn[2]), rng, flips).smallest_p <= LEVEL,
    }


def until_held(slow: FloatArray, quick: FloatArray, size: int, rng: np.random.Generator) -> float:
    """The share of intervals that hold the time until which the pools' own difference is significant."""
    differences = slow - quick
    t = differences.mean(axis=0) / (differences.std(axis=0) / np.sqrt(size))
    truth = 100.0 * (np.flatnonzero(t > 1.96)[-1] + 1)
    found = []
    for _ in range(UNTIL_SAMPLES):
        rows = rng.choice(len(slow), size)
        seen = last_difference(curves(slow[rows]), curves(quick[rows]), rng)
        found.append(seen.low <= truth <= seen.high)
    return float(np.mean(found))


def _single(sample: Sample) -> Curves:
    return Curves(sample.name, np.zeros(1), sample.values[:, None], sample.replicates)


def _sped_up(pace: float) -> Callable[[FloatArray], FloatArray]:
    places = np.minimum((pace * np.arange(1, 201)).astype(int), 200) - 1
    return lambda values: values[:, places]


def shares(rows: list[dict[str, bool]]) -> dict[str, float]:
    return {name: round(float(np.mean([row[name] for row in rows])), 3) for name in rows[0]}


def measured(everyone: FloatArray, repetitions: int, flips: int) -> dict[str, Any]:
    """Level and power by test, and the coverage of "until"."""
    rng = np.random.default_rng(1)
    power = {
        str(pace): shares([rejections(everyone, rng, flips, _sped_up(pace)) for _ in range(repetitions)])
        for pace in PACES
    }
    learners = shares([pairs_of_learners(everyone, rng, flips) for _ in range(repetitions)])
    margin = float(np.mean([at_the_margin(everyone, rng) for _ in range(repetitions)]))
    bad = pool(one_path(Approach.FIXED, NOT_BENEFICIAL, 0.1), len(everyone))
    until = {str(size): round(until_held(everyone, bad, size, rng), 3) for size in SIZES}
    return {
        "power_by_pace": power,
        "level_of_learners": learners,
        "equivalence_at_the_margin": round(margin, 3),
        "until_held": until,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pool", type=int, default=1000)
    parser.add_argument("--repetitions", type=int, default=1000)
    parser.add_argument("--flips", type=int, default=1000)
    arguments = parser.parse_args()
    everyone = pool(SMALL_NO_IMITATION, arguments.pool)
    print(json.dumps(vars(arguments) | measured(everyone, arguments.repetitions, arguments.flips)))


if __name__ == "__main__":
    main()
