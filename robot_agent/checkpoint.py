"""What a restarted agent goes on from: one JSON file a robot, replaced in one step."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from swarm.errors import UserError

VERSION = 2
"""Of the file's content; 1 kept the memory and the counters in other places."""


class Checkpoint:
    """The file of one robot's snapshot; nothing but JSON is ever read.

    `run` tells runs apart, so that no trial goes on from another's learning.
    """

    def __init__(self, directory: Path, robot: str, run: str) -> None:
        self.path = directory / f"{robot}.json"
        self._run = run

    def load(self) -> dict[str, Any] | None:
        """The last saved snapshot, or None at the first start; UserError if the file is damaged."""
        try:
            content = json.loads(self.path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise UserError(f"{self.path}: not a checkpoint ({error}); move it away to start anew") from error
        if not isinstance(content, dict) or content.get("version") != VERSION:
            raise UserError(f"{self.path}: not a checkpoint of version {VERSION}; move it away to start anew")
        if content.get("run") != self._run:
            raise UserError(
                f"{self.path}: of {content.get('run')}, not of {self._run}; move it away to start anew"
            )
        return content

    def save(self, snapshot: dict[str, Any]) -> None:
        """Write beside the old file, bring it to the disk, then put it in the old one's place."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        beside = self.path.with_suffix(".part")
        with beside.open("w", encoding="utf-8") as file:
            json.dump({"version": VERSION, "run": self._run, **snapshot}, file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(self.path)
