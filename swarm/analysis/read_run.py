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
from swarm.analysis.tables import LEARNING, TABLE_OF, Rejected, is_learning, is_tabled, rows

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
    names = tuple(dict.fromkeys((TABLE_OF if sampled else LEARNING).values()))
    files = TableFiles(folder, names)
    healths, contents = [], []
    try:
        for identity in logs:
            health, content = _read_log(identity, files, sampled, show)
            healths.append(health)
            contents.append(content)
        tables = files.finish()
    finally:
        files.discard()
    health = pl.concat(healths)
    health.write_parquet(folder / "health.parquet")
    return Reading(tables | {"health": folder / "health.parquet"}, health, contents)


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
            files.add(found)
            bad = len(found.rejected)
            rejected.extend(islice(found.rejected, max(0, REJECTED_SHOWN - len(rejected))))
        health.add(part, bad)
        show(len(part.sequence))
    return health.frame(), LogContent(identity, reader.messages, reader.damage, rejected)
