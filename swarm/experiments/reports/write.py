"""The report's three files."""

from __future__ import annotations

import json
from pathlib import Path

from swarm.experiments.assessment import Assessment
from swarm.experiments.reports.as_html import as_html
from swarm.experiments.reports.as_json import as_json
from swarm.experiments.reports.as_markdown import as_markdown
from swarm.experiments.store import write_whole


def write_report(assessment: Assessment, command: str) -> dict[str, Path]:
    """Write claims.md, claims.json and claims.html beside the plots; return them by form."""
    texts = {
        "markdown": ("claims.md", as_markdown(assessment, command)),
        "json": ("claims.json", json.dumps(as_json(assessment), indent=1, allow_nan=False) + "\n"),
        "html": ("claims.html", as_html(assessment, command)),
    }
    assessment.folder.mkdir(parents=True, exist_ok=True)
    return {form: _written(assessment.folder / name, text) for form, (name, text) in texts.items()}


def _written(path: Path, text: str) -> Path:
    write_whole(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
    return path
