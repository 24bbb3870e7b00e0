"""Is a log complete and sound? Every reason why it is not, in words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import polars as pl

from swarm.logs.completeness import HealthTable, health_totals
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.reader import LogReader
from swarm.logs.tables import is_tabled, rows
from swarm.logs.trial_logs import by_trial, logs_in


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
    return _checked([identify(path)])


def check_run(run: Path) -> list[LogCheck]:
    """The trials of a run directory, each with all of its logs: what is missing between them is missing."""
    return [_checked(parts) for parts in by_trial(logs_in(run))]


def _checked(parts: list[LogIdentity]) -> LogCheck:
    health = HealthTable(parts[0])
    readers = [_read(part, health) for part in parts]
    found = health.frame()
    faults = [fault for reader in readers for fault in _damage(reader, named=len(parts) > 1)]
    return LogCheck(
        parts[0].path,
        sum(reader.messages for reader in readers),
        all(reader.recorded_messages is not None for reader in readers),
        faults + _faults(found),
        _remarks(found),
    )


def _read(identity: LogIdentity, health: HealthTable) -> LogReader:
    """A sender has a channel in each of a trial's logs: here they are one, but those that servers drew."""
    reader = LogReader(identity.path, is_tabled)
    for part in reader.parts():
        rejected = len(rows(part, identity).rejected) if part.payloads else 0
        number = 1 if part.channel.epoch else identity.part
        health.add(replace(part, channel=replace(part.channel, id=number)), rejected)
    return reader


def _damage(reader: LogReader, named: bool) -> list[str]:
    """Why a log is not sound by its own bytes; `named`: with the file's name."""
    faults = [str(damage) for damage in reader.damage]
    if not faults and reader.recorded_messages is None:
        faults = ["the log has no index"]
    return [f"{reader.path.name}: {fault}" for fault in faults] if named else faults


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
