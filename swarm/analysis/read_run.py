"""Logs to tables on the disk, in one pass over each log."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import polars as pl

from swarm.analysis.health_table import HealthTable
from swarm.analysis.log_identity import LogIdentity
from swarm.analysis.log_reader import Damage, LogReader
from swarm.analysis.table_files import TableFiles
from swarm.analysis.tables import (
    LEARNING,
    TABLE_OF,
    WATCHING,
    Rejected,
    is_learning,
    is_tabled,
    rows,
    table_names,
)

REJECTED_SHOWN = 100


@dataclass
class LogContent:
    """What reading one log came to."""

    identity: LogIdentity
    messages: int
    damage: list[Damage]
    rejected: list[Rejected] = field(default_factory=list)
    """The first of the messages that could not be decoded."""


@dataclass
class Reading:
    """The tables of all logs: table -> Parquet file, and how each log was."""

    tables: dict[str, Path]
    health: pl.DataFrame
    logs: list[LogContent]


def read_logs(
    logs: Sequence[LogIdentity], folder: Path, sampled: bool, show: Callable[[int], object]
) -> Reading:
    """Write the tables of all logs into `folder`; `sampled`: also poses, commands and truths.

    `show` is told now and then how many more messages have been read.
    """
    files = TableFiles(folder, table_names(TABLE_OF if sampled else LEARNING | WATCHING))
    healths, contents = [], []
    try:
        for identity in logs:
            health, content = _read_log(identity, files, sampled, show)
            healths.append(health)
            contents.append(content)
        tables = _without_empty(files.finish(), table_names(WATCHING))
    finally:
        files.discard()
    health = pl.concat(healths)
    health.write_parquet(folder / "health.parquet")
    return Reading(tables | {"health": folder / "health.parquet"}, health, contents)


def _without_empty(tables: dict[str, Path], names: Sequence[str]) -> dict[str, Path]:
    """Remove some tables if all of them are without rows."""
    if any(pl.scan_parquet(tables[name]).select(pl.len()).collect().item() for name in names):
        return tables
    for name in names:
        tables[name].unlink()
    return {name: path for name, path in tables.items() if name not in names}


def _read_log(
    identity: LogIdentity, files: TableFiles, sampled: bool, show: Callable[[int], object]
) -> tuple[pl.DataFrame, LogContent]:
    wanted = is_tabled if sampled else is_learning
    reader, health = LogReader(identity.path, wanted), HealthTable(identity)
    rejected: list[Rejected] = []
    for part in reader.parts():
        bad = 0
        if part.payloads:
            found = rows(part, identity)
            for table in found.tables:
                files.add(table)
            bad = len(found.rejected)
            rejected.extend(islice(found.rejected, max(0, REJECTED_SHOWN - len(rejected))))
        health.add(part, bad)
        show(len(part.sequence))
    return health.frame(), LogContent(identity, reader.messages, reader.damage, rejected)
