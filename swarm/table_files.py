"""Tables as files: whole, and with the disk's errors in its own words."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swarm.files import write_whole

if TYPE_CHECKING:
    import polars as pl

FULL_BYTES = 4096
"""A disk with less than a block of this size takes no file."""


def write_table(table: pl.DataFrame, path: Path) -> Path:
    """A table, whole: as text if the name ends in .csv, else as Parquet."""
    return write_whole(path, table.write_csv if path.suffix == ".csv" else as_parquet(table))


def as_parquet(table: pl.DataFrame | pl.LazyFrame, **options: Any) -> Callable[[Path], None]:
    """Writes a table into a file; OSError if the disk does not take it, for which polars has other words."""
    import polars as pl

    def write(path: Path) -> None:
        try:
            if isinstance(table, pl.LazyFrame):
                table.sink_parquet(path, **options)
            else:
                table.write_parquet(path, **options)
        except pl.exceptions.ComputeError as error:
            is_full = shutil.disk_usage(path.parent).free < FULL_BYTES
            number = errno.ENOSPC if is_full else errno.EIO
            raise OSError(number, os.strerror(number), str(path)) from error

    return write
