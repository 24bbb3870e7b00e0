"""Everything that a page shows, as plain data: made from the logs alone, and the same whenever it is made."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.analysis.comparison import NoComparison
from swarm.analysis.inputs import Inputs
from swarm.analysis.page.curves import page_curves
from swarm.analysis.page.learning import page_learning
from swarm.analysis.page.sources import Sources
from swarm.analysis.page.tables import page_tables
from swarm.analysis.plots import interval_note
from swarm.analysis.summary import Summary
from swarm.files import printable
from swarm.markdown import counted

MADE_BY = "swarm analyze --html"


@dataclass(frozen=True)
class Origin:
    """What a page is made of, and where it lies: runs are named from there."""

    runs: Sequence[Path]
    inputs: Inputs
    place: Path
    """The page's folder."""

    def labelled(self, text: str) -> str:
        """With a run's name in place of its path, which is another one elsewhere."""
        for run in sorted(self.runs, key=lambda run: -len(printable(run))):
            text = text.replace(printable(run), printable(Path(run.resolve().name)))
        return text

    def relative(self, path: Path) -> str:
        return printable(Path(os.path.relpath(path.resolve(), self.place.resolve())))


def page_contents(summary: Summary, tables: Mapping[str, Path], origin: Origin) -> dict[str, Any]:
    """What the page's script shows, and what `swarm verify` makes once more."""
    sources = Sources(origin.inputs.logs)
    curves, found_tables = page_curves(summary, sources), page_tables(summary, sources)
    learning, left_out = page_learning(tables, sources)
    notes = [origin.labelled(note) for note in summary.notes]
    notes += [each.reason for each in summary.comparisons if isinstance(each, NoComparison)]
    if left_out:
        notes.append(f"the learning of {counted(left_out, 'more robot')} would make this file too large")
    return {
        "made_by": MADE_BY,
        "title": summary.title,
        "note": interval_note(summary.curves),
        "cap": summary.curves.cap,
        "threshold": summary.threshold,
        "runs": [origin.relative(run) for run in origin.runs],
        "logs": [_log(log) for log in summary.reading.logs],
        "notes": notes,
        "curves": curves,
        "tables": found_tables,
        "learning": learning,
        "sources": sources.listed,
    }


def _log(log: Any) -> dict[str, Any]:
    identity = log.identity
    return {
        "name": printable(Path(identity.path.parent.resolve().name) / identity.path.name),
        "sha256": identity.digest,
        "messages": log.messages,
        "seed": identity.seed,
        "trial": identity.trial,
        "commit": identity.commit,
    }
