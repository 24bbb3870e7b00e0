"""What an analysis found, in numbers: the same for the printed table, the JSON and the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from swarm.analysis.comparison import Comparison, NoComparison
from swarm.analysis.copying.summary import Copying
from swarm.analysis.learning_curves import RunCurves
from swarm.logs.completeness import health_totals
from swarm.logs.parquet import LogContent, Reading
from swarm.statistics.intervals import interval
from swarm.statistics.samples import Curves, mean_level
from swarm.statistics.survival import median_time, times_to_threshold


@dataclass(frozen=True)
class Summary:
    """Everything that an analysis has to say; `as_json` is what `--json` prints."""

    title: str
    reading: Reading
    curves: RunCurves
    comparisons: Sequence[Comparison | NoComparison]
    threshold: int
    """Path length, in moves, at which a learner counts as having found a good path."""
    notes: Sequence[str]
    copying: Copying
    """Says nothing of runs in which no path was remembered and no visit made."""

    def conditions(self) -> dict[str, dict[str, Any]]:
        """condition -> how far and how well its learners came."""
        return {name: _condition(curves, self.threshold) for name, curves in self.curves.curves.items()}

    def as_json(self) -> dict[str, Any]:
        return {
            "messages": sum(log.messages for log in self.reading.logs),
            "conditions": self.conditions(),
            "cap": self.curves.cap,
            "threshold": self.threshold,
            "comparisons": [_comparison(found) for found in self.comparisons],
            **({"copying": self.copying.as_json()} if self.copying else {}),
            "health": health_totals(self.reading.health),
            "logs": [_log(log) for log in self.reading.logs],
            "notes": list(self.notes),
        }


def _condition(curves: Curves, threshold: int) -> dict[str, Any]:
    band, final = interval(curves), curves.values[:, -1]
    arrival = times_to_threshold(curves, threshold, lasting=True)
    median = median_time(arrival)
    return {
        "trials": len(curves.values),
        "moves": int(curves.times[-1]),
        "final_mean": float(final.mean()),
        "final_of_each_trial": final.tolist() if band is None else None,
        "final_low": None if band is None else float(band.low[-1]),
        "final_high": None if band is None else float(band.high[-1]),
        "mean_over_run": float(mean_level(curves).values.mean()),
        "shortest": float(curves.values.min()),
        "reached_threshold": int(arrival.observed.sum()),
        "median_moves_to_threshold": None if median is None else int(median),
    }


def _comparison(found: Comparison | NoComparison) -> dict[str, Any]:
    names: dict[str, Any] = {"first": found.first, "second": found.second}
    if isinstance(found, NoComparison):
        return names | {"reason": found.reason}
    return names | {
        "pairs": found.pairs,
        "moves": found.moves,
        "mean_difference": found.effect.mean_difference,
        "mean_interval": [float(end) for end in found.effect.mean_interval],
        "d_z": found.effect.d_z,
        "p": found.p,
        "windows": [[window.start, window.end] for window in found.windows],
        "honest_windows": [[window.start, window.end] for window in found.family_wise_windows],
    }


def _log(log: LogContent) -> dict[str, Any]:
    return {
        "log": log.identity.name,
        "run": log.identity.run,
        "seed": log.identity.seed,
        "trial": log.identity.trial,
        "sha256": log.identity.digest,
        "messages": log.messages,
        "damage": [str(damage) for damage in log.damage],
    }
