"""What runs recorded, for a notebook or a script: tables, learning curves, copied paths, figures.

What `swarm analyze` writes into files is here to be worked with, made by the same code.
"""

from __future__ import annotations

import atexit
import shutil
from functools import cached_property
from os import PathLike
from pathlib import Path
from tempfile import mkdtemp

import polars as pl
from matplotlib.figure import Figure

from swarm.analysis.copying.figures import copying_figures
from swarm.analysis.copying.paths import path_table
from swarm.analysis.copying.summary import Copying, read_copying
from swarm.analysis.inputs import Inputs, find_inputs
from swarm.analysis.learning_curves import RunCurves, curve_table, run_curves, trial_table
from swarm.analysis.plots import plot_curves
from swarm.errors import UserError, nearest
from swarm.logs.identity import LogIdentity
from swarm.logs.parquet import Reading, read_logs
from swarm.logs.tables import SAMPLED


class RecordedRun:
    """The logs of one run, or of several pooled.

    The logs are read when something of them is first asked for, once, into Parquet files that last as long
    as the interpreter: a lazy table may be collected after this object is gone. Poses, commands and truths,
    nearly all of a log, are read only if one of them is asked for.
    """

    def __init__(self, *runs: str | PathLike[str]) -> None:
        self._inputs: Inputs = find_inputs([Path(run) for run in runs])
        self._folder = Path(mkdtemp(prefix="swarm-run-"))
        atexit.register(shutil.rmtree, self._folder, ignore_errors=True)

    @property
    def logs(self) -> tuple[LogIdentity, ...]:
        """Which trials of which runs the logs hold."""
        return self._inputs.logs

    @property
    def notes(self) -> list[str]:
        """What a reader of results should know: trials that are missing, curves that were cut."""
        return [*self._inputs.notes, *self._curves.notes]

    @property
    def tables(self) -> list[str]:
        """The names that `table` knows."""
        return sorted({*self._learning.tables, *SAMPLED.values()})

    def table(self, name: str) -> pl.LazyFrame:
        """A table with a row a message, lazily: `.collect()` reads what is still asked for.

        Columns carry their units; `log`, `trial`, `condition` and `robot` say whose message it was,
        `publish_t_ns` when it was sent. UserError for a name that is not in `tables`.
        """
        if name not in self.tables:
            raise UserError(f"no table {name!r} in these logs; {nearest(name, self.tables)}")
        reading = self._everything if name in SAMPLED.values() else self._learning
        return pl.scan_parquet(reading.tables[name], glob=False)

    def learning_curves(self) -> pl.DataFrame:
        """Best path length: a row a condition and point, `mean` over trials with its 95 % interval."""
        return curve_table(self._curves.curves)

    def trial_curves(self) -> pl.DataFrame:
        """Best path length: a row a condition, trial and point, before any averaging."""
        return trial_table(self._curves)

    def copied_paths(self) -> pl.DataFrame:
        """A row a remembered path: its moves, R and replays, and the copying error where it is known."""
        return path_table(self._copying.paths)

    def plot_learning_curves(self) -> Figure:
        """Mean best path length of each condition against moves, as in the paper's figure 25."""
        return plot_curves(self._curves, ", ".join(dict.fromkeys(log.run for log in self.logs)))

    def plot_copying(self) -> dict[str, Figure]:
        """The paper's figures 27 to 29 for this run: those that there is something for, by name."""
        figures = copying_figures(self._copying)
        return {Path(name).stem: figure for name, figure in figures.items()}

    @cached_property
    def _learning(self) -> Reading:
        return self._read("learning", sampled=False)

    @cached_property
    def _everything(self) -> Reading:
        return self._read("everything", sampled=True)

    def _read(self, name: str, *, sampled: bool) -> Reading:
        folder = self._folder / name
        folder.mkdir()
        return read_logs(self.logs, folder, sampled, lambda _: None)

    @cached_property
    def _curves(self) -> RunCurves:
        return run_curves(
            pl.read_parquet(self._learning.tables["best_paths"], glob=False), self._inputs.shortest_moves
        )

    @cached_property
    def _copying(self) -> Copying:
        return read_copying(self._learning.tables, {log.trial_log: log.cell_m for log in self.logs})
