"""Where results go: a new directory, or one whose results come from the very same logs.

Results can always be made again from the logs, so results of the same logs may be written over. A
directory that holds anything else is never touched.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.analysis.inputs import Inputs
from swarm.errors import UserError

MADE_BY = "swarm analyze"
CURE = "choose another --out"


@dataclass(frozen=True)
class AnalysisDirectory:
    """`inputs.json` (which logs, by their SHA-256), `report.md`, `summary.json`, `curves.*`, `tables/`."""

    path: Path

    @classmethod
    def open(cls, path: Path, inputs: Inputs) -> AnalysisDirectory:
        """Make the directory, or take over one with the same inputs; UserError for any other."""
        record = {"made_by": MADE_BY, "logs": [_record(log.path, log.digest) for log in inputs.logs]}
        try:
            path.mkdir(parents=True, exist_ok=True)
            if any(path.iterdir()):
                _refuse_another(path, record)
            directory = cls(path)
            directory.tables.mkdir(exist_ok=True)
            directory.write_json("inputs.json", record)
        except OSError as error:
            reason = error.strerror or str(error)
            raise UserError(f"{path}: results cannot be written there ({reason}); {CURE}") from error
        return directory

    @property
    def tables(self) -> Path:
        return self.path / "tables"

    def write(self, name: str, write: Callable[[Path], object]) -> Path:
        """Call `write` with a temporary name and give the file its own name once it is whole."""
        path, beside = self.path / name, self.path / f".{name}.{os.getpid()}.part"
        try:
            write(beside)
            beside.replace(path)
        except OSError as error:
            raise UserError(f"{path}: cannot be written ({error.strerror}); {CURE}") from error
        finally:
            beside.unlink(missing_ok=True)
        return path

    def write_json(self, name: str, content: Mapping[str, Any]) -> Path:
        text = json.dumps(content, indent=2, allow_nan=False) + "\n"
        return self.write(name, lambda path: path.write_text(text, encoding="utf-8"))

    def write_text(self, name: str, text: str) -> Path:
        return self.write(name, lambda path: path.write_text(text, encoding="utf-8"))


def _record(path: Path, digest: str) -> dict[str, str]:
    return {"log": str(path), "sha256": digest}


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
