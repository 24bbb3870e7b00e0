"""Runs side by side: the curves of all their conditions, and every two of them tested, all tests together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from swarm.analysis.comparison import Comparison, NoComparison, compare
from swarm.analysis.inputs import Inputs, find_inputs
from swarm.analysis.learning_curves import RunCurves, curve_table, read_curves
from swarm.analysis.plots import interval_note, plot_curves
from swarm.analysis.report import sentence
from swarm.analysis.results_directory import AnalysisDirectory
from swarm.errors import UserError
from swarm.files import printable, write_png, write_text
from swarm.markdown import counted, table, text_number
from swarm.statistics.intervals import interval
from swarm.statistics.multiple_tests import holm
from swarm.statistics.paired_tests import LEVEL
from swarm.statistics.samples import Curves
from swarm.table_files import write_table

NAMED = 3
"""Runs that a directory of results is called after; more are counted."""


@dataclass(frozen=True)
class PairTest:
    """Two curves side by side, among so many pairs."""

    comparison: Comparison
    p: float
    """Of the mean difference, adjusted for all pairs (Holm)."""

    @property
    def differs(self) -> bool:
        return self.p <= LEVEL


@dataclass(frozen=True)
class RunComparison:
    """The curves by `RUN: CONDITION`, the pairs that could be tested, and why others could not."""

    curves: RunCurves
    pairs: Sequence[PairTest]
    untested: Sequence[NoComparison]

    def as_json(self) -> dict[str, Any]:
        return {
            "curves": {name: _curve(curves) for name, curves in self.curves.curves.items()},
            "level": LEVEL,
            "pairs": [_pair(pair) for pair in self.pairs],
            "untested": [vars(pair) for pair in self.untested],
            "notes": list(self.curves.notes),
        }


def compare_runs(runs: Sequence[Path]) -> tuple[RunComparison, list[Inputs]]:
    """Every condition of every run against every other; UserError for fewer than two runs."""
    if len(runs) < 2:
        raise UserError("one run is compared with nothing: name two or more (`swarm analyze` looks at one)")
    inputs = [find_inputs([run]) for run in runs]
    merged = _merged(dict(zip(_labels(runs), inputs, strict=True)))
    pairs = list(combinations(merged.curves.values(), 2))
    found = [compare(first, second, together=len(pairs)) for first, second in pairs]
    tested = [each for each in found if isinstance(each, Comparison)]
    adjusted = holm([each.p for each in tested])
    untested = [each for each in found if isinstance(each, NoComparison)]
    return RunComparison(merged, list(map(PairTest, tested, adjusted)), untested), inputs


def _labels(runs: Sequence[Path]) -> list[str]:
    """Each run by its directory's name, by its path where two have the same."""
    names = [printable(Path(run.resolve().name)) for run in runs]
    return [name if names.count(name) == 1 else printable(run) for name, run in zip(names, runs, strict=True)]


def _merged(inputs: dict[str, Inputs]) -> RunCurves:
    curves: dict[str, Curves] = {}
    notes: list[str] = []
    cap = 0
    for label, logs in inputs.items():
        with TemporaryDirectory(prefix="swarm-compare-") as folder:
            found = read_curves(logs.logs, Path(folder))
        cap = max(cap, found.cap)
        notes += [f"{label}: {note}" for note in [*logs.notes, *found.notes]]
        for condition, of_condition in found.curves.items():
            name = f"{label}: {condition}"
            curves[name] = replace(of_condition, name=name)
    return RunCurves(curves, cap, notes)


def default_place(runs: Sequence[Path]) -> Path:
    """`runs/comparisons/A-B`."""
    names = [run.resolve().name.removesuffix(".mcap") for run in runs]
    more = [f"{len(names) - NAMED}-more"] if len(names) > NAMED else []
    return Path("runs") / "comparisons" / "-".join([*names[:NAMED], *more])


def write_comparison(found: RunComparison, inputs: Sequence[Inputs], out: Path) -> dict[str, Path]:
    """`curves.png`, `curves.csv` and `report.md` into a directory that is new, or of the same logs."""
    logs = tuple(log for each in inputs for log in each.logs)
    place = AnalysisDirectory.open(out, Inputs(logs)).path
    picture = plot_curves(found.curves, "Best path while learning")
    return {
        "curves.png": write_png(picture, place / "curves.png"),
        "curves.csv": write_table(curve_table(found.curves.curves), place / "curves.csv"),
        "report.md": write_text(_report(found), place / "report.md"),
    }


def curve_rows(found: RunComparison) -> list[list[str]]:
    """A row for each curve, under `CURVE_HEAD`."""
    return [
        [name, str(row["trials"]), f"{row['moves']:,}", text_number(row["mean"]), text_number(row["final"])]
        for name, row in ((name, _curve(curves)) for name, curves in found.curves.curves.items())
    ]


CURVE_HEAD = ["run: condition", "trials", "moves", "mean path", "path at the end"]
PAIR_HEAD = [
    "first",
    "second",
    "pairs",
    "difference",
    "95 % interval",
    "d_z",
    "95 % interval",
    "p",
    "p of all",
]


def pair_rows(found: RunComparison) -> list[list[str]]:
    """A row for each tested pair, under `PAIR_HEAD`."""
    return list(map(_pair_row, found.pairs))


def _pair_row(pair: PairTest) -> list[str]:
    found, effect = pair.comparison, pair.comparison.effect
    return [
        found.first,
        found.second,
        str(found.pairs),
        f"{effect.mean_difference:+.1f}",
        _range(effect.mean_interval, "+.1f"),
        f"{effect.d_z:.2f}",
        _range(effect.d_z_interval, ".2f"),
        f"{found.p:.2g}",
        f"{pair.p:.2g}{' *' if pair.differs else ''}",
    ]


def level_note(found: RunComparison) -> str:
    """At which level what is tested, and what a star means."""
    count = counted(len(found.pairs), "pair")
    return (
        "Differences are of the mean best path over all moves, first minus second, in moves; less is better. "
        f"`p of all` is Student's paired t-test adjusted for {count} (Holm): a star is a difference at "
        f"{LEVEL:.0%}, and the probability of any false star is at most that."
    )


def pair_line(pair: PairTest) -> str:
    """The same as a row in words, for a narrow screen."""
    first, second, pairs, difference, around, d_z, around_d_z, p, p_of_all = _pair_row(pair)
    return (
        f"{first} minus {second}, {pairs} pairs: {difference} moves ({around}), "
        f"d_z {d_z} ({around_d_z}), p {p}, of all {p_of_all}"
    )


def _range(ends: tuple[float, float], form: str) -> str:
    return f"{ends[0]:{form}} to {ends[1]:{form}}"


def _report(found: RunComparison) -> str:
    sections = [
        "# Runs side by side",
        "![Best path length against moves](curves.png)",
        interval_note(found.curves),
        table(CURVE_HEAD, curve_rows(found)),
    ]
    if found.pairs:
        along = [f"- {sentence(pair.comparison)}" for pair in found.pairs]
        sections += ["## In pairs", level_note(found), table(PAIR_HEAD, pair_rows(found)), "\n".join(along)]
    if found.untested:
        sections += ["## Not tested", "\n".join(f"- {pair.reason}" for pair in found.untested)]
    if found.curves.notes:
        sections += ["## Notes", "\n".join(f"- {note}" for note in found.curves.notes)]
    return "\n\n".join(sections) + "\n"


def _curve(curves: Curves) -> dict[str, Any]:
    band = interval(curves)
    ends = None if band is None else [float(band.low[-1]), float(band.high[-1])]
    return {
        "trials": len(curves.values),
        "moves": int(curves.times[-1]),
        "mean": float(curves.values.mean()),
        "final": float(curves.values[:, -1].mean()),
        "final_interval": ends,
    }


def _pair(pair: PairTest) -> dict[str, Any]:
    found = pair.comparison
    return {
        "first": found.first,
        "second": found.second,
        "pairs": found.pairs,
        "moves": found.moves,
        "mean_difference": found.effect.mean_difference,
        "mean_interval": list(found.effect.mean_interval),
        "d_z": found.effect.d_z,
        "d_z_interval": list(found.effect.d_z_interval),
        "p": found.p,
        "p_of_all": pair.p,
        "differs": pair.differs,
        "windows_of_all": [[window.start, window.end] for window in found.family_wise_windows],
    }
