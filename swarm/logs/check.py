"""Is a log complete and sound? Every reason why it is not, in words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from swarm.logs.completeness import HealthTable, health_totals
from swarm.logs.identity import identify
from swarm.logs.reader import LogReader
from swarm.logs.tables import is_tabled, rows


@dataclass(frozen=True)
class LogCheck:
    """What was found in a log."""

    path: Path
    messages: int
    indexed: bool
    faults: list[str]
    """Why it is not sound: damage, no index, learning events lost, duplicates, undecodable messages."""
    remarks: list[str]
    """What is worth knowing and no fault: restarts, states of which only the newest counts, slow keys."""

    @property
    def sound(self) -> bool:
        return not self.faults

    def as_json(self) -> dict[str, Any]:
        return {
            "log": str(self.path),
            "sound": self.sound,
            "messages": self.messages,
            "indexed": self.indexed,
            "faults": self.faults,
            "remarks": self.remarks,
        }


def check_log(path: Path) -> LogCheck:
    """Read every byte and decode every message; LogError for what is no log of a run."""
    identity = identify(path)
    reader, health = LogReader(path, is_tabled), HealthTable(identity)
    for part in reader.parts():
        health.add(part, len(rows(part, identity).rejected) if part.payloads else 0)
    found = health.frame()
    indexed = reader.recorded_messages is not None
    faults = [str(damage) for damage in reader.damage]
    if not indexed and not faults:
        faults.append("the log has no index")
    return LogCheck(path, reader.messages, indexed, faults + _faults(found), _remarks(found))


def _faults(health: pl.DataFrame) -> list[str]:
    every = pl.col("delivery") == "every"
    return [
        *_counts(health.filter(every), "missing", "messages missing"),
        *_counts(health, "duplicates", "duplicates"),
        *_counts(health, "rejected", "messages that cannot be decoded"),
    ]


def _remarks(health: pl.DataFrame) -> list[str]:
    totals = health_totals(health)
    remarks = _counts(health.filter(pl.col("delivery") != "every"), "missing", "messages missing")
    remarks += [f"{key}: below half of its declared rate" for key in totals["slow_keys"]]
    remarks += [f"{key}: of a type that is not known here" for key in totals["unreadable_keys"]]
    restarted = health.filter(pl.col("restart") > 0)["robot"].unique().sort()
    return remarks + [f"{robot}: restarted during the trial" for robot in restarted]


def _counts(health: pl.DataFrame, column: str, what: str) -> list[str]:
    """A line for each key with more than none in a column."""
    counted = health.group_by("key").agg(pl.col(column).sum()).filter(pl.col(column) > 0).sort("key")
    return [f"{key}: {count} {what}" for key, count in counted.iter_rows()]
