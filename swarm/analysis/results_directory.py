"""Where results go: a new directory, or one whose results come from the very same logs.

Results can always be made again from the logs, so results of the same logs may be written over. A
directory that holds anything else is never touched.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.analysis.inputs import Inputs
from swarm.errors import RunFailedError, UserError
from swarm.files import printable, write_json

MADE_BY = "swarm analyze"
CURE = "choose another --out"


@dataclass(frozen=True)
class AnalysisDirectory:
    """`inputs.json` (which logs, by their SHA-256), `report.md`, `summary.json`, `curves.*`, `tables/`."""

    path: Path

    @classmethod
    def open(cls, path: Path, inputs: Inputs) -> AnalysisDirectory:
        """Make the directory, or take over one with the same inputs; UserError for any other."""
        record = {"made_by": MADE_BY, "logs": [_record(log.name, log.digest) for log in inputs.logs]}
        if printable(path) != str(path):
            raise UserError(f"{printable(path)}: Parquet files must have a name that is UTF-8; {CURE}")
        try:
            path.mkdir(parents=True, exist_ok=True)
            if any(path.iterdir()):
                _refuse_another(path, record)
            write_json(record, path / "inputs.json")
        except (OSError, RunFailedError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise UserError(f"{path}: results cannot be written there ({reason}); {CURE}") from error
        return cls(path)

    @property
    def tables(self) -> Path:
        return self.path / "tables"


def _record(name: str, digest: str) -> dict[str, str]:
    return {"log": name, "sha256": digest}


def _refuse_another(path: Path, asked: Mapping[str, Any]) -> None:
    try:
        there = json.loads((path / "inputs.json").read_text(encoding="utf-8"))
        digests = [log["sha256"] for log in there["logs"]] if there["made_by"] == MADE_BY else None
    except (OSError, ValueError, KeyError, TypeError):
        digests = None
    if digests is None:
        raise UserError(f"{path}: holds something else than results of {MADE_BY}; {CURE}")
    if digests != [log["sha256"] for log in asked["logs"]]:
        raise UserError(f"{path}: holds the results of other logs, or of these before they grew; {CURE}")
