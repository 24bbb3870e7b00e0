"""Everything that a run leaves behind: one new directory, nothing overwritten."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.errors import UserError


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
        return self.path / f"trial-{trial:03}.mcap"

    def output(self, trial: int) -> Path:
        """Where the processes of a trial print to."""
        return self.path / "output" / f"trial-{trial:03}"

    def write_json(self, name: str, content: Mapping[str, Any]) -> None:
        """Replace one of the directory's own JSON files in one step."""
        beside = self.path / f".{name}.part"
        beside.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
        beside.replace(self.path / name)


def _free(parent: Path, name: str) -> Path:
    pattern = re.compile(re.escape(name) + r"-(\d+)")
    taken = [pattern.fullmatch(entry.name) for entry in parent.glob(f"{name}-*")]
    return parent / f"{name}-{max((int(match[1]) for match in taken if match), default=0) + 1:03}"
