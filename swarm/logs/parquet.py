"""Logs to Parquet tables on the disk, in one pass over each log and through a bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import polars as pl

from swarm.files import write_whole
from swarm.logs.completeness import HealthTable
from swarm.logs.episodes import journeys, visits
from swarm.logs.identity import LogIdentity
from swarm.logs.reader import Damage, LogReader
from swarm.logs.tables import (
    LEARNING,
    TABLE_OF,
    WATCHING,
    Rejected,
    Rows,
    empty_table,
    is_learning,
    is_tabled,
    rows,
    table_names,
)
from swarm.logs.trial_logs import as_one
from swarm.logs.units import parquet_metadata
from swarm.table_files import as_parquet

ROWS_IN_MEMORY = 500_000
"""Of a table: some 60 MB of the widest."""


@dataclass
class TableFiles:
    """Collects rows and leaves one `NAME.parquet` a table in `folder`."""

    folder: Path
    names: tuple[str, ...]
    """The tables that there will be, with rows or without."""
    _frames: dict[str, list[pl.DataFrame]] = field(default_factory=dict)
    _waiting: dict[str, int] = field(default_factory=dict)
    _parts: dict[str, list[Path]] = field(default_factory=dict)

    def add(self, rows: Rows) -> None:
        """Append rows to their table."""
        name = rows.table
        self._frames.setdefault(name, []).append(rows.frame)
        self._waiting[name] = self._waiting.get(name, 0) + rows.frame.height
        if self._waiting[name] >= ROWS_IN_MEMORY:
            self._spill(name)

    def finish(self) -> dict[str, Path]:
        """Write what is left and join the parts of each table; table -> file."""
        return {name: self._joined(name) for name in self.names}

    def discard(self) -> None:
        """Remove the parts of tables that were not finished."""
        for paths in self._parts.values():
            for path in paths:
                path.unlink(missing_ok=True)

    def _spill(self, name: str) -> None:
        parts = self._parts.setdefault(name, [])
        path = self.folder / f".{name}-{len(parts):05}.part"
        parts.append(path)
        as_parquet(pl.concat(self._frames.pop(name)))(path)
        self._waiting[name] = 0

    def _joined(self, name: str) -> Path:
        parts = self._parts.pop(name, [])
        units = parquet_metadata(empty_table(name).columns)
        if parts:
            rest = pl.concat(self._frames.pop(name, []) or [empty_table(name)])
            spilled = [pl.scan_parquet(part, glob=False) for part in parts]
            whole: pl.DataFrame | pl.LazyFrame = pl.concat([*spilled, rest.lazy()])
        else:
            whole = pl.concat([empty_table(name), *self._frames.pop(name, [])])
        path = write_whole(self.folder / f"{name}.parquet", as_parquet(whole, metadata=units))
        for part in parts:
            part.unlink()
        return path


REJECTED_SHOWN = 100
"""Of a log: they are examples, and a bad sender may have sent millions."""


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
    healths: dict[str, HealthTable] = {}
    contents = []
    try:
        for identity in logs:
            health = healths.setdefault(identity.trial_log, HealthTable(identity))
            contents.append(_read_log(identity, files, health, sampled, show))
        tables = _without_empty(files.finish(), table_names(WATCHING))
    finally:
        files.discard()
    health_frame = pl.concat([health.frame() for health in healths.values()])
    together = {"health": health_frame} | _episodes(tables)
    written = {name: _write(frame, folder / f"{name}.parquet") for name, frame in together.items()}
    return Reading(tables | written, health_frame, contents)


def _episodes(tables: dict[str, Path]) -> dict[str, pl.DataFrame]:
    """The tables of journeys and, where there were any, of visits."""
    found = {"journeys": journeys(pl.read_parquet(tables["moves"], glob=False))}
    if "visit_phases" in tables:
        watched = (
            pl.read_parquet(tables[name], glob=False)
            for name in ("visit_phases", "observations", "copy_errors")
        )
        found["visits"] = visits(*watched)
    return found


def _write(table: pl.DataFrame, path: Path) -> Path:
    return write_whole(path, as_parquet(table, metadata=parquet_metadata(table.columns)))


def _without_empty(tables: dict[str, Path], names: Sequence[str]) -> dict[str, Path]:
    """Remove some tables if all of them are without rows."""
    if any(pl.scan_parquet(tables[name], glob=False).select(pl.len()).collect().item() for name in names):
        return tables
    for name in names:
        tables[name].unlink()
    return {name: path for name, path in tables.items() if name not in names}


def _read_log(
    identity: LogIdentity,
    files: TableFiles,
    health: HealthTable,
    sampled: bool,
    show: Callable[[int], object],
) -> LogContent:
    wanted = is_tabled if sampled else is_learning
    reader = LogReader(identity.path, wanted)
    rejected: list[Rejected] = []
    for part in reader.parts():
        bad = 0
        if part.payloads:
            found = rows(part, identity)
            for table in found.tables:
                files.add(table)
            bad = len(found.rejected)
            rejected.extend(islice(found.rejected, max(0, REJECTED_SHOWN - len(rejected))))
        health.add(as_one(part, identity), bad)
        show(len(part.sequence))
    return LogContent(identity, reader.messages, reader.damage, rejected)
