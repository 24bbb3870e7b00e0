"""How often the 95 % intervals of a mean best path length hold the truth, and how often they leave the scale.

The population is many runs of the engine (section 2.2 of the paper), from learners that know nothing, most of
them at the cap, to ones of which nearly all have a short path. Small samples are drawn from it.

    python -m tests.benchmarks.intervals [--runs 1000] [--samples 2000]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from swarm.gridworld.simulation import simulate
from swarm.paper.conditions import SMALL_NO_IMITATION
from swarm.statistics.intervals import pointwise_t_band
from swarm.statistics.samples import FloatArray, Scale

SCALE = Scale(9.0, 100.0)
"""The shortest path of the arena, and what a path that does not arrive counts as."""
STEPS, POINTS = 4000, (50, 100, 150, 200, 250, 300, 350, 399)
"""From learners that know nothing to ones of which nearly all have found the shortest path."""
SIZES = (2, 3, 4, 5, 8, 12, 20, 40, 100)
"""Trials: the paper's robots made 4, its simulations 100 runs."""
RESAMPLES = 1000
"""Of the bootstrap: the tails hold 25 each."""
ROUNDING = 1e-9
"""In moves."""

Limits = tuple[FloatArray, FloatArray]
Method = Callable[[FloatArray, np.random.Generator], Limits]


def student(values: FloatArray, _: np.random.Generator) -> Limits:
    """Student's t."""
    band = pointwise_t_band(values)
    return band.low, band.high


def cut_off(values: FloatArray, _: np.random.Generator) -> Limits:
    """What of Student's t lies on the scale."""
    band = pointwise_t_band(values)
    low, high = np.clip([band.low, band.high], SCALE.lowest, SCALE.highest)
    return low, high


def logit(values: FloatArray, _: np.random.Generator) -> Limits:
    """Student's t on the logit's axis: what the project uses, of `FEWEST` trials or more."""
    band = pointwise_t_band(values, SCALE)
    return band.low, band.high


def percentile(values: FloatArray, rng: np.random.Generator) -> Limits:
    """The bootstrap's percentiles."""
    weights = rng.multinomial(len(values), np.full(len(values), 1 / len(values)), size=RESAMPLES)
    low, high = np.quantile(weights @ values / len(values), [0.025, 0.975], axis=0)
    return low, high


METHODS: dict[str, Method] = {
    "Student's t": student,
    "Student's t, cut off at the scale": cut_off,
    "t on the logit": logit,
    "bootstrap percentiles": percentile,
}


def population(runs: int) -> FloatArray:
    """Best path lengths (runs, points)."""
    condition = replace(SMALL_NO_IMITATION, goal_reachings=None, steps=STEPS, points=None)
    rows = [simulate(condition, 1, run).best_path_length[0] for run in range(runs)]
    return np.array([[row[point - 1] for point in POINTS] for row in rows], dtype=np.float64)


def score(method: Method, everyone: FloatArray, size: int, samples: int) -> tuple[float, float, float]:
    """Over all points: the shares of intervals that hold the truth and that leave the scale; mean width."""
    rng = np.random.default_rng(1)
    truth = everyone.mean(axis=0)
    held, width, outside = [], [], []
    for _ in range(samples):
        low, high = method(everyone[rng.choice(len(everyone), size, replace=False)], rng)
        held.append((low - ROUNDING <= truth) & (truth <= high + ROUNDING))
        width.append(high - low)
        outside.append((low < SCALE.lowest - ROUNDING) | (high > SCALE.highest + ROUNDING))
    return float(np.mean(held)), float(np.mean(outside)), float(np.mean(width))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=2000)
    arguments = parser.parse_args()
    everyone = population(arguments.runs)
    print("true means:", ", ".join(f"{mean:.1f}" for mean in everyone.mean(axis=0)))
    at_the_cap = (everyone == SCALE.highest).mean(axis=0)
    print("at the cap:", ", ".join(f"{share:.0%}" for share in at_the_cap))
    print("\n| method | trials | holds the truth | leaves the scale | mean width |")
    print("| --- | --- | --- | --- | --- |")
    for name, method in METHODS.items():
        for size in SIZES:
            held, outside, width = score(method, everyone, size, arguments.samples)
            print(f"| {name} | {size} | {held:.1%} | {outside:.1%} | {width:.1f} |", flush=True)


if __name__ == "__main__":
    main()
