"""The analysis as a page to read: Markdown with the figure, the numbers and everything that was left out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import polars as pl

from swarm.analysis.comparison import Comparison, NoComparison
from swarm.analysis.copying.drawing import moves_text
from swarm.analysis.copying.report import copying_section
from swarm.analysis.plots import interval_note
from swarm.analysis.summary import Summary
from swarm.logs.completeness import health_totals, log_state
from swarm.markdown import table, text_number
from swarm.statistics.paired_tests import LEVEL, Window

_SHOWN = 20
"""Rows of a table that is read, not searched."""
_LEGEND = (
    "Path at the end: mean best path length in moves. Last columns: how many trials came down to that "
    "length and stayed there, and after how many moves half of all trials had (Kaplan-Meier)."
)


def report(summary: Summary, figure: str, copying_pictures: Iterable[str] = ()) -> str:
    """The whole page; `figure` and `copying_pictures` are the pictures' file names."""
    sections = (
        f"# {summary.title}",
        f"![Best path length against moves]({figure})",
        f"{interval_note(summary.curves)} The best path is the greedy path on the Q-values, evaluated every "
        f"ten moves; one that does not arrive counts as {summary.curves.cap}. The learners of one condition "
        "in one trial enter as their average: the trial is what is independent.",
        _conditions(summary),
        _comparisons(summary.comparisons),
        _paths(summary),
        copying_section(summary.copying, copying_pictures),
        _notes(summary),
        _logs(summary),
        _health(summary),
    )
    return "\n\n".join(section for section in sections if section) + "\n"


def condition_rows(summary: Summary) -> list[list[str]]:
    """A row of text for each condition, under `condition_head`."""
    return [_condition_row(name, values) for name, values in summary.conditions().items()]


def condition_head(summary: Summary) -> list[str]:
    return [
        "condition",
        "trials",
        "moves",
        "path at the end",
        "95 % interval",
        f"at {summary.threshold} or less",
        "median moves to it",
    ]


def _condition_row(name: str, values: dict[str, Any]) -> list[str]:
    median = values["median_moves_to_threshold"]
    return [
        name,
        str(values["trials"]),
        f"{values['moves']:,}",
        text_number(values["final_mean"]),
        _interval(values),
        f"{values['reached_threshold']} of {values['trials']}",
        text_number(median, 0),
    ]


def _interval(values: dict[str, Any]) -> str:
    """The interval at the end, or what every trial came to where the trials are too few for one."""
    low, high, each = values["final_low"], values["final_high"], values["final_of_each_trial"]
    if each is None:
        return f"{text_number(low)} to {text_number(high)}"
    return "none, 1 trial" if len(each) == 1 else f"none; trials: {', '.join(map(text_number, sorted(each)))}"


def _conditions(summary: Summary) -> str:
    return f"## Learning\n\n{table(condition_head(summary), condition_rows(summary))}\n\n{_LEGEND}"


def _comparisons(comparisons: Sequence[Comparison | NoComparison]) -> str:
    if not comparisons:
        return ""
    return "## Comparisons\n\n" + "\n".join(f"- {sentence(found)}" for found in comparisons)


def sentence(found: Comparison | NoComparison) -> str:
    """One comparison in words."""
    if isinstance(found, NoComparison):
        return f"**{found.first} and {found.second}**: no paired test. {found.reason}."
    low, high = found.effect.mean_interval
    smallest = 2.0 ** (1 - found.pairs)
    text = (
        f"**{found.first} minus {found.second}**, {found.pairs} pairs of the same seed and trial, over "
        f"{found.moves:,} moves: {found.effect.mean_difference:+.1f} moves of best path "
        f"(95 % interval {low:+.1f} to {high:+.1f}; d_z {found.effect.d_z:.2f}; p = {found.p:.2g}). "
        f"Pointwise t-test at 5 %, as in the paper: {_windows(found.windows)}. "
        f"All points tested together (max-T sign flips): {_windows(found.family_wise_windows)}."
    )
    if smallest > LEVEL:
        text += f" With {found.pairs} pairs that test cannot find any: its smallest p is {smallest:.2g}."
    return text


def _windows(windows: Sequence[Window]) -> str:
    if not windows:
        return "no difference"
    longest = sorted(windows, key=lambda window: window.duration, reverse=True)[:3]
    shown = ", ".join(_window(window) for window in sorted(longest, key=lambda window: window.start))
    return shown if len(windows) <= len(longest) else f"{len(windows)} windows, the longest {shown}"


def _window(window: Window) -> str:
    if window.start == window.end:
        return f"move {window.start:,.0f}"
    return f"moves {window.start:,.0f} to {window.end:,.0f}"


def _paths(summary: Summary) -> str:
    """Remembered paths, numbered as in the pictures, with how often each was replayed and its last R."""
    paths = summary.copying.enacted
    if not paths:
        return ""
    head = ["condition", "robot", "seed", "trial", "path", "moves", "source", "replays", "R at the end"]
    body = [
        [
            path.condition,
            path.robot,
            str(path.seed),
            str(path.trial),
            str(path.path),
            moves_text(path.moves),
            path.source,
            f"{path.replays:,}",
            text_number(path.ratio, 2),
        ]
        for path in paths[:_SHOWN]
    ]
    shown = "" if len(body) == len(paths) else f"The {len(body)} most replayed of {len(paths)}.\n\n"
    return f"## Paths\n\n{shown}{table(head, body)}"


def _notes(summary: Summary) -> str:
    return "## Notes\n\n" + "\n".join(f"- {note}" for note in summary.notes) if summary.notes else ""


def _logs(summary: Summary) -> str:
    rows = [
        [
            log.identity.name,
            log.identity.run,
            str(log.identity.seed),
            str(log.identity.trial),
            f"{log.messages:,}",
            log_state(summary.reading.health, log.identity, bool(log.damage)),
            log.identity.digest[:16],
        ]
        for log in summary.reading.logs
    ]
    return "## Logs\n\n" + table(["log", "run", "seed", "trial", "messages", "state", "sha256"], rows)


def _health(summary: Summary) -> str:
    """Totals, and a row for every key that is not as it should be."""
    health = summary.reading.health
    totals = health_totals(health)
    text = (
        f"## Health\n\n{totals['missing']:,} messages missing ({totals['missing_events']:,} of them "
        f"learning events or orders), {totals['duplicates']:,} duplicates, "
        f"{totals['rejected']:,} not decodable, {totals['restarts']:,} restarts of a sender "
        "(by key). `tables/health.parquet` has every key."
    )
    odd = health.filter(
        (pl.col("missing") + pl.col("duplicates") + pl.col("rejected") + pl.col("restart") > 0)
        | pl.col("key").is_in(totals["slow_keys"])
    )
    if odd.is_empty():
        return text
    columns = (
        "trial",
        "key",
        "epoch",
        "messages",
        "declared_hz",
        "seen_hz",
        "missing",
        "duplicates",
        "rejected",
    )
    rows = [[_cell(row[name]) for name in columns] for row in odd.head(_SHOWN).iter_rows(named=True)]
    return f"{text}\n\n{table(list(columns), rows)}"


def _cell(value: Any) -> str:
    return text_number(value, 2) if value is None or isinstance(value, float) else str(value)
