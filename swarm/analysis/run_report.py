"""The analysis as a page to read: Markdown with the figure, the numbers and everything that was left out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import polars as pl

from swarm.analysis.copying_report import copying_section
from swarm.analysis.run_comparison import LEVEL, Comparison, NoComparison
from swarm.analysis.run_figures import interval_note
from swarm.analysis.run_summary import Summary, health_totals
from swarm.analysis.windows import Window
from swarm.geometry import Move

_SHOWN = 20
_LEGEND = (
    "Path at the end: mean best path length in moves. Last columns: how many trials came down to that "
    "length and stayed there, and after how many moves half of all trials had (Kaplan-Meier)."
)


def report(summary: Summary, figure: str, copying_pictures: Sequence[str] = ()) -> str:
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


def text_number(value: float | None, digits: int = 1) -> str:
    """A number as a person reads it; an en dash for none."""
    return "–" if value is None else f"{value:,.{digits}f}"


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
    low, high = values["final_low"], values["final_high"]
    median = values["median_moves_to_threshold"]
    return [
        name,
        str(values["trials"]),
        f"{values['moves']:,}",
        text_number(values["final_mean"]),
        "none, 1 trial" if low is None else f"{text_number(low)} to {text_number(high)}",
        f"{values['reached_threshold']} of {values['trials']}",
        text_number(median, 0),
    ]


def _conditions(summary: Summary) -> str:
    return f"## Learning\n\n{_table(condition_head(summary), condition_rows(summary))}\n\n{_LEGEND}"


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
        f"All points tested together (max-T sign flips): {_windows(found.honest_windows)}."
    )
    if smallest > LEVEL:
        text += f" With {found.pairs} pairs that test cannot find any: its smallest p is {smallest:.2g}."
    return text


def _windows(windows: Sequence[Window]) -> str:
    if not windows:
        return "no difference"
    longest = sorted(windows, key=lambda window: window.duration, reverse=True)[:3]
    shown = ", ".join(f"moves {w.start:,.0f} to {w.end:,.0f}" for w in sorted(longest, key=lambda w: w.start))
    return shown if len(windows) <= len(longest) else f"{len(windows)} windows, the longest {shown}"


def _paths(summary: Summary) -> str:
    """Remembered paths, with how often each was replayed and its last R."""
    paths = pl.read_parquet(summary.reading.tables["paths"])
    if paths.is_empty():
        return ""
    replays = pl.read_parquet(summary.reading.tables["replays"])
    of_path = ["log", "robot", "path"]
    counted = (
        replays.sort("receive_t_ns").group_by(of_path).agg(replays=pl.len(), ratio=pl.col("ratio").last())
    )
    rows = (
        paths.unique(of_path, keep="last", maintain_order=True)
        .join(counted, on=of_path, how="left", maintain_order="left")
        .sort("replays", descending=True, nulls_last=True)
        .head(_SHOWN)
    )
    head = ["condition", "robot", "seed", "trial", "path", "source", "replays", "R at the end"]
    body = [
        [
            row["condition"],
            row["robot"],
            str(row["seed"]),
            str(row["trial"]),
            moves_text(row["moves"]),
            row["source"],
            f"{row['replays'] or 0:,}",
            text_number(row["ratio"], 2),
        ]
        for row in rows.iter_rows(named=True)
    ]
    title = f"## Paths\n\nThe {len(body)} most replayed of {paths.height}.\n\n"
    return title + _table(head, body)


def moves_text(moves: Iterable[int]) -> str:
    """Compass moves in words, such as "SE SE E"."""
    return " ".join(Move(move).name if 0 <= move < len(Move) else "?" for move in moves)


def _notes(summary: Summary) -> str:
    return "## Notes\n\n" + "\n".join(f"- {note}" for note in summary.notes) if summary.notes else ""


def _logs(summary: Summary) -> str:
    rows = [
        [
            str(log.identity.path),
            log.identity.run,
            str(log.identity.seed),
            str(log.identity.trial),
            f"{log.messages:,}",
            "complete" if not log.damage else "damaged",
            log.identity.digest[:16],
        ]
        for log in summary.reading.logs
    ]
    return "## Logs\n\n" + _table(["log", "run", "seed", "trial", "messages", "state", "sha256"], rows)


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
    return f"{text}\n\n{_table(list(columns), rows)}"


def _cell(value: Any) -> str:
    return text_number(value, 2) if value is None or isinstance(value, float) else str(value)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)
