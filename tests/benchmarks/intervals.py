"""How often the 95 % bands of a mean best path length hold the truth, of 4 to 100 runs.

The population is many runs of the engine (section 2.2 of the paper), from learners that know nothing, most of
them at the cap, to ones of which nearly all have a short path. Samples are drawn from it, so that its mean is
their truth. Prints one JSON line: for each number of runs the shares of points and of whole curves that are
held, of the project's bands and of Student's t; and the mean widths.

    python -m tests.benchmarks.intervals [--runs 1000] [--samples 500]
"""

from __future__ import annotations

import argparse
import json

import numpy as np

from swarm.gridworld.simulation import simulate
from swarm.paper.conditions import SMALL_NO_IMITATION, shortened
from swarm.statistics.intervals import Band, ends_of, interval, pointwise_t_band, simultaneous_band
from swarm.statistics.samples import BoolArray, Curves, Scale

SCALE = Scale(9.0, 100.0)
"""The shortest path of the arena, and what a path that does not arrive counts as."""
STEPS, EVERY = 20_000, 400
"""Of the paper's figures; 50 points."""
SIZES = (4, 10, 30, 100)
"""Runs: the paper's robots made 4, its simulations 100."""
RESAMPLES = 500
"""Of a simultaneous band: 25 lie in its tail."""
ROUNDING = 1e-9
"""In moves."""


def population(runs: int) -> Curves:
    """Best path lengths (runs, points)."""
    condition = shortened(SMALL_NO_IMITATION, STEPS)
    rows = [simulate(condition, 1, run).best_path_length[0] for run in range(runs)]
    times = 10 * np.arange(1.0, len(rows[0]) + 1)
    curves = Curves("population", times, np.array(rows, dtype=np.float64), tuple(range(runs)), SCALE)
    return curves.every(EVERY // 10)


def held(band: Band, truth: np.ndarray) -> BoolArray:
    """At which points the band holds the truth."""
    inside: BoolArray = (band.low - ROUNDING <= truth) & (truth <= band.high + ROUNDING)
    return inside


def score(everyone: Curves, size: int, samples: int) -> dict[str, float]:
    """The shares held by bands of so many runs, and their widths."""
    rng = np.random.default_rng(size)
    truth = everyone.values.mean(axis=0)
    points, student, whole, width = [], [], [], []
    for _ in range(samples):
        values = everyone.values[rng.choice(len(everyone.values), size)]
        curves = Curves("sample", everyone.times, values, tuple(range(size)), SCALE)
        band = interval(curves)
        assert band is not None
        wide = simultaneous_band(values, rng, ends_of(curves), resamples=RESAMPLES)
        points.append(held(band, truth))
        student.append(held(pointwise_t_band(values), truth))
        whole.append(held(wide, truth).all())
        width.append((band.high - band.low).mean())
    return {
        "points": float(np.mean(points)),
        "worst_point": float(np.mean(points, axis=0).min()),
        "student": float(np.mean(student)),
        "student_worst_point": float(np.mean(student, axis=0).min()),
        "whole_curve": float(np.mean(whole)),
        "mean_width_moves": float(np.mean(width)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=500)
    arguments = parser.parse_args()
    everyone = population(arguments.runs)
    found = {str(size): score(everyone, size, arguments.samples) for size in SIZES}
    rounded = {size: {name: round(share, 3) for name, share in row.items()} for size, row in found.items()}
    print(json.dumps({"samples": arguments.samples, "points": len(everyone.times), "runs": rounded}))


if __name__ == "__main__":
    main()
