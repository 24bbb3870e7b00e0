"""From logs to everything that `swarm analyze` leaves behind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import polars as pl

from swarm.analysis.comparison import compare_all
from swarm.analysis.copying.figures import copying_figures
from swarm.analysis.copying.paths import path_table
from swarm.analysis.copying.summary import Copying, read_copying
from swarm.analysis.inputs import Inputs, default_out, find_inputs
from swarm.analysis.learning_curves import curve_table, run_curves, trial_table
from swarm.analysis.page.contents import Origin, page_contents
from swarm.analysis.page.document import write_page
from swarm.analysis.page.verification import Verification, compared, runs_of
from swarm.analysis.plots import plot_curves
from swarm.analysis.report import report
from swarm.analysis.results_directory import AnalysisDirectory
from swarm.analysis.summary import Summary
from swarm.files import printable, write_json, write_png, write_text
from swarm.logs.identity import LogIdentity
from swarm.logs.parquet import LogContent, Reading, read_logs
from swarm.table_files import write_table

_DAMAGE_SHOWN = 3
"""Of a log: enough to see what is wrong with it."""


@dataclass(frozen=True)
class Request:
    """What a call of `swarm analyze` asks for."""

    runs: Sequence[Path]
    out: Path | None = None
    sampled: bool = True
    """Also tables of poses, commands and truths, which are nearly all of a log."""
    threshold: int = 12
    """Moves: a third above the shortest path of the paper's arena, 9."""
    html: bool = False
    """Also one page to hand round."""


@dataclass(frozen=True)
class Analysis:
    """What came of it."""

    summary: Summary
    directory: Path
    files: dict[str, Path]

    def as_json(self) -> dict[str, Any]:
        files = {name: printable(path) for name, path in self.files.items()}
        return {"analysis": printable(self.directory), "files": files, **self.summary.as_json()}


def analyze(request: Request, show: Callable[[int], object] = lambda _: None) -> Analysis:
    """Read the logs, write tables, curves, figure and report; `show` is told of messages read."""
    out = request.out or default_out(request.runs)
    inputs = find_inputs(request.runs)
    directory = AnalysisDirectory.open(out, inputs)
    directory.tables.mkdir(exist_ok=True)
    reading = read_logs(inputs.logs, directory.tables, request.sampled, show)
    summary = _summary(inputs, reading, request.threshold)
    files = _write(directory, summary)
    if request.html:
        page = page_contents(summary, reading.tables, Origin(request.runs, inputs, directory.path))
        files["report.html"] = write_page(page, directory.path / "report.html")
    analysis = Analysis(summary, directory.path, files | reading.tables)
    write_json(analysis.as_json(), directory.path / "summary.json")
    return analysis


def verify(page: Path, runs: Sequence[Path] = ()) -> Verification:
    """Make every number of a page of `analyze` once more from its logs; `runs`: where these are by now."""
    contents, places = runs_of(page, runs)
    inputs = find_inputs(places)
    with TemporaryDirectory(prefix="swarm-verify-") as folder:
        reading = read_logs(inputs.logs, Path(folder), False, lambda _: None)
        summary = _summary(inputs, reading, int(contents["threshold"]))
        again = page_contents(summary, reading.tables, Origin(places, inputs, page.parent))
    return compared(page, contents, again)


def _summary(inputs: Inputs, reading: Reading, threshold: int) -> Summary:
    best_paths = pl.read_parquet(reading.tables["best_paths"], glob=False)
    curves = run_curves(best_paths, inputs.shortest_moves)
    notes = [*inputs.notes, *_reading_notes(inputs, reading), *curves.notes]
    copying = read_copying(reading.tables, {log.trial_log: log.cell_m for log in inputs.logs})
    return Summary(_title(inputs), reading, curves, compare_all(curves), threshold, notes, copying)


def _write(directory: AnalysisDirectory, summary: Summary) -> dict[str, Path]:
    curves = summary.curves
    tables = {"curves": curve_table(curves.curves), "trials": trial_table(curves)}
    drawn = _write_figures(directory, summary)
    return {
        **drawn,
        **{
            f"{name}.{form}": write_table(table, directory.path / f"{name}.{form}")
            for name, table in tables.items()
            for form in ("csv", "parquet")
        },
        "report.md": write_text(report(summary, "curves.png", drawn), directory.path / "report.md"),
        **_write_paths(directory, summary.copying),
    }


def _write_figures(directory: AnalysisDirectory, summary: Summary) -> dict[str, Path]:
    figures = {"curves.png": plot_curves(summary.curves, summary.title)}
    if summary.copying:
        figures["curves_paper_axes.png"] = plot_curves(summary.curves, summary.title, paper_axes=True)
    figures |= copying_figures(summary.copying)
    return {name: write_png(figure, directory.path / name) for name, figure in figures.items()}


def _write_paths(directory: AnalysisDirectory, copying: Copying) -> dict[str, Path]:
    """The table of remembered paths, if there are any."""
    if not copying.paths:
        return {}
    path = directory.tables / "copied_paths.parquet"
    return {"copied_paths": write_table(path_table(copying.paths), path)}


def _title(inputs: Inputs) -> str:
    names = list(dict.fromkeys(log.run for log in inputs.logs))
    shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    return f"{shown}: best path while learning"


def _reading_notes(inputs: Inputs, reading: Reading) -> list[str]:
    best_paths = pl.read_parquet(reading.tables["best_paths"], columns=["log", "robot"], glob=False)
    reported = set(best_paths.unique().iter_rows())
    notes = [note for log in reading.logs for note in _damage_notes(log)]
    notes += [note for log in inputs.logs for note in _silent_notes(log, reported)]
    return notes


def _damage_notes(log: LogContent) -> list[str]:
    name = log.identity.name
    notes = [f"{name}: {damage}" for damage in log.damage[:_DAMAGE_SHOWN]]
    if len(log.damage) > _DAMAGE_SHOWN:
        notes.append(f"{name}: {len(log.damage) - _DAMAGE_SHOWN} more damaged places")
    if log.rejected:
        first = log.rejected[0]
        example = f"{first.key} number {first.sequence}: {first.reason}"
        notes.append(f"{name}: messages that could not be decoded were left out, such as {example}")
    return notes


def _silent_notes(log: LogIdentity, reported: set[tuple[str, str]]) -> list[str]:
    """Learners that made too few moves for a single point of their curve."""
    silent = sorted(robot for robot in log.learners if (log.trial_log, robot) not in reported)
    return [f"{log.name}: {robot} reported no best path and is left out" for robot in silent]
