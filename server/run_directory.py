"""Everything that a run leaves behind: one new directory, nothing overwritten."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.errors import NO_ROOM, UserError


@dataclass(frozen=True)
class RunDirectory:
    """A run's directory: `experiment.toml`, `manifest.json` (conditions x trials x seeds), `run.json`
    (what differs between two runs of one seed), `trial-000.mcap` and so on, `output/` of the processes.
    """

    path: Path

    @classmethod
    def create(cls, path: Path | None, name: str) -> RunDirectory:
        """A new directory; without a path the first free runs/NAME-001, -002 and so on."""
        chosen = path or _free(Path("runs"), name)
        try:
            chosen.parent.mkdir(parents=True, exist_ok=True)
            chosen.mkdir()
        except FileExistsError as error:
            raise UserError(
                f"{chosen}: exists already; nothing is overwritten, choose another --out"
            ) from error
        except OSError as error:
            raise UserError(f"{chosen}: cannot be made ({error.strerror}); choose another --out") from error
        return cls(chosen)

    def keep_experiment(self, file: Path) -> Path:
        """A copy of the experiment file, byte for byte."""
        return Path(shutil.copyfile(file, self.path / "experiment.toml"))

    def log(self, trial: int) -> Path:
        return self.path / f"{trial_name(trial)}.mcap"

    def output(self, trial: int) -> Path:
        """Where the processes of a trial print to."""
        return self.path / "output" / trial_name(trial)

    def reserve(self) -> None:
        """Take room now for what is written once there is none: how the run ended."""
        self._reserve.write_bytes(bytes(RESERVED_BYTES))

    def release(self) -> None:
        """Give the room back."""
        self._reserve.unlink(missing_ok=True)

    def remove(self) -> None:
        """Leave nothing of a run that never began."""
        shutil.rmtree(self.path, ignore_errors=True)

    def write_json(self, name: str, content: Mapping[str, Any]) -> None:
        """Replace one of the directory's own JSON files in one step; on a full disk in the reserved room."""
        try:
            self._replace(name, content)
        except OSError as error:
            if error.errno not in NO_ROOM:
                raise
            self.release()
            self._replace(name, content)

    def _replace(self, name: str, content: Mapping[str, Any]) -> None:
        beside = self.path / f".{name}.part"
        try:
            beside.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
            beside.replace(self.path / name)
        except OSError:
            beside.unlink(missing_ok=True)
            raise

    @property
    def _reserve(self) -> Path:
        return self.path / ".reserve"


RESERVED_BYTES = 1 << 20
"""A manifest takes 150 bytes for each robot and trial: thousands have room."""


def trial_name(trial: int) -> str:
    """A trial as its log is called: 0 is `trial-000`."""
    return f"trial-{trial:03}"


def _free(parent: Path, name: str) -> Path:
    pattern = re.compile(re.escape(name) + r"-(\d+)")
    taken = [pattern.fullmatch(entry.name) for entry in parent.glob(f"{name}-*")]
    return parent / f"{name}-{max((int(match[1]) for match in taken if match), default=0) + 1:03}"
