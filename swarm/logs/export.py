"""A log in the formats of other programs: a file a table, or a bag for ROS 2."""

from __future__ import annotations

import shutil
from enum import StrEnum
from pathlib import Path

import polars as pl

from swarm.errors import UserError
from swarm.files import new_folder
from swarm.logs.identity import identify
from swarm.logs.parquet import read_logs
from swarm.logs.trial_logs import joined, logs_of_trial
from swarm.table_files import write_table


class Format(StrEnum):
    """What `swarm export --to` makes."""

    CSV = "csv"
    PARQUET = "parquet"
    ROSBAG2 = "rosbag2"


def export_log(log: Path, to: Format, out: Path) -> list[Path]:
    """Write a log, or all logs of a trial, into a new folder, whole or not at all; the files, in order."""
    if out.exists():
        raise UserError(f"{out}: exists already; nothing is overwritten, choose another --out")
    logs = joined(map(identify, logs_of_trial([log])))
    if to is Format.ROSBAG2:
        from swarm.logs.rosbag2 import write_bag

        return write_bag([each.path for each in logs], out)
    new_folder(out)
    try:
        tables = sorted(read_logs(logs, out, sampled=True, show=lambda _: None).tables.values())
        return [_as_csv(table) for table in tables] if to is Format.CSV else tables
    except BaseException:
        shutil.rmtree(out)
        raise


def _as_csv(table: Path) -> Path:
    """In the Parquet file's place. CSV has no lists: their items stand in one cell, with blanks between."""
    frame = pl.read_parquet(table, glob=False)
    lists = [name for name, kind in frame.schema.items() if kind == pl.List]
    joined = frame.with_columns(pl.col(name).cast(pl.List(pl.String)).list.join(" ") for name in lists)
    written = write_table(joined, table.with_suffix(".csv"))
    table.unlink()
    return written
