"""How well robots copy, from rendered frames to lists; `python -m tests.benchmarks.rendered_copying`.

Prints one JSON line: for each profile, light and kind of demonstration the shares of lists that are

- `imperfect`: anything but the whole list of moves, a refusal included;
- `wrong`: other than what was shown in the time from which moves were copied, as the server judges it;
- `refused`: nothing was copied, with the reasons;

with 95 % intervals (Wilson), the mean edit distance to the whole list, and CPU seconds a demonstration (with
rendering). `--csv FILE` also writes the table. `--conditions` picks some, such as best/hard/random.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import time
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

from robot_agent.imitation.copying import NoCopy
from robot_agent.offline.observation_session import observed_demonstrations, offline_experiment
from swarm.config.experiment import CopyProfile
from swarm.learning.alignment import edit_distance

BARS = {
    "best/realistic/random": ("imperfect", 0.0, 0.01),
    "best/realistic/expert": ("imperfect", 0.0, 0.01),
    "best/hard/random": ("wrong", 0.0, 0.06),
    "best/hard/expert": ("wrong", 0.0, 0.06),
    "paper/realistic/random": ("imperfect", 0.30, 0.70),
    "paper/realistic/expert": ("imperfect", 0.30, 0.70),
}
"""Which share is bounded, and its bounds. Under hard conditions posts stand before the demonstrator."""


@dataclass(frozen=True)
class Score:
    """What came of one condition's demonstrations."""

    condition: str
    demonstrations: int
    imperfect: float
    imperfect_low: float
    imperfect_high: float
    wrong: float
    wrong_low: float
    wrong_high: float
    refused: float
    edit_mean: float
    seen: float
    cpu_s: float
    met: bool
    reasons: dict[str, int]


def score(condition: str, count: int, seed: int) -> Score:
    """Rehearse, and compare every copied list with the true one; no copy counts as an empty list."""
    profile, light, kind = condition.split("/")
    experiment = offline_experiment(CopyProfile(profile), light)
    edits, reasons = [], Counter[str]()
    wrong, seen = 0, 0.0
    began_s = time.process_time()
    for observed in observed_demonstrations(experiment, kind, count, seed):
        edits.append(edit_distance(observed.copied_moves, list(map(int, observed.demonstration.moves))))
        wrong += observed.copied_moves != observed.moves_meanwhile
        seen += len(observed.watch.positions) / max(1, len(observed.watch.looks))
        if isinstance(observed.copied, NoCopy):
            reasons[observed.copied.reason] += 1
    shares = {"imperfect": 1 - edits.count(0) / count, "wrong": wrong / count}
    bounded, least, most = BARS[condition]
    return Score(
        condition,
        count,
        *_with_interval(shares["imperfect"], count),
        *_with_interval(shares["wrong"], count),
        round(sum(reasons.values()) / count, 4),
        round(sum(edits) / count, 4),
        round(seen / count, 4),
        round((time.process_time() - began_s) / count, 3),
        least <= shares[bounded] <= most,
        dict(reasons),
    )


def _with_interval(share: float, count: int) -> tuple[float, float, float]:
    low, high = wilson(share, count)
    return round(share, 4), round(low, 4), round(high, 4)


def wilson(share: float, count: int, z: float = 1.96) -> tuple[float, float]:
    """The 95 % score interval of a proportion (Wilson 1927)."""
    middle = share + z * z / (2 * count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    scale = 1 + z * z / count
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)


def write_csv(scores: list[Score], path: Path) -> None:
    """A row for each condition."""
    rows = [{name: value for name, value in asdict(each).items() if name != "reasons"} for each in scores]
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--conditions", nargs="+", default=list(BARS), choices=list(BARS))
    parser.add_argument("--csv", type=Path, default=None)
    arguments = parser.parse_args()
    scores = [
        score(condition, arguments.demonstrations, arguments.seed) for condition in arguments.conditions
    ]
    if arguments.csv:
        write_csv(scores, arguments.csv)
    met = all(each.met for each in scores)
    table = {each.condition: asdict(each) for each in scores}
    print(
        json.dumps(
            {"benchmark": "rendered_copying", "seed": arguments.seed, "bars_met": met, "scores": table}
        )
    )


if __name__ == "__main__":
    main()
