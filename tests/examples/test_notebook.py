"""The example notebook runs from its first cell to its last, in a kernel of its own."""

from __future__ import annotations

from pathlib import Path

import nbformat
from nbclient import NotebookClient

from tests.support.swarm_runs import ROOT

NOTEBOOK = ROOT / "examples" / "look_at_a_run.ipynb"
PATIENCE_S = 24 * 3600
"""The kernel may start as slowly as a busy machine lets it."""


def opened() -> nbformat.NotebookNode:
    notebook: nbformat.NotebookNode = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    return notebook


def test_the_notebook_runs_and_shows_tables_and_figures(tmp_path: Path) -> None:
    notebook = opened()
    folder = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, startup_timeout=PATIENCE_S, resources=folder).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    shown = [kind for output in outputs for kind in output.get("data", {})]
    assert shown.count("image/png") == 2
    assert shown.count("text/html") >= 3, "a table is shown as a table"


def test_the_notebook_is_kept_without_outputs() -> None:
    assert not [cell for cell in opened().cells if cell.get("outputs") or cell.get("execution_count")]
