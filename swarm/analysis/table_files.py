"""Tables on the way to the disk: a log of any length passes through a bounded amount of memory."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import polars as pl

from swarm.analysis.tables import Rows, empty_table

ROWS_IN_MEMORY = 500_000


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
        pl.concat(self._frames.pop(name)).write_parquet(path)
        self._waiting[name] = 0

    def _joined(self, name: str) -> Path:
        path, beside = self.folder / f"{name}.parquet", self.folder / f".{name}.parquet.part"
        parts = self._parts.pop(name, [])
        if parts:
            rest = pl.concat(self._frames.pop(name, []) or [empty_table(name)])
            pl.concat([*map(pl.scan_parquet, parts), rest.lazy()]).sink_parquet(beside)
        else:
            pl.concat([empty_table(name), *self._frames.pop(name, [])]).write_parquet(beside)
        beside.replace(path)
        for part in parts:
            part.unlink()
        return path
