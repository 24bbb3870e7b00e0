"""Everything that a run leaves behind: one new directory, nothing overwritten."""

from __future__ import annotations

import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.control.reaching import ENDPOINT
from swarm.errors import NO_ROOM, UserError
from swarm.files import new_folder
from swarm.logs.recover import close_log
from swarm.logs.trial_logs import OPEN_SUFFIX

EXPERIMENT, MANIFEST = "experiment.toml", "manifest.json"


@dataclass(frozen=True)
class RunDirectory:
    """A run's directory: `experiment.toml`, `manifest.json` (conditions x trials x seeds), `run.json`
    (what differs between two runs of one seed), `trial-000.mcap` and so on, `output/` of the processes.

    Where a trial's log goes on in more files they are `trial-000-2.mcap` and so on; the one that is being
    written has `.part` at its end.
    """

    path: Path
    is_new: bool = True
    """Whether no other server has left anything here."""

    @classmethod
    def create(cls, path: Path | None, name: str) -> RunDirectory:
        """A new directory; without a path the first free runs/NAME-001, -002 and so on."""
        chosen = path or _free(Path("runs"), name)
        return cls(new_folder(chosen))

    @contextmanager
    def held(self) -> Iterator[None]:
        """UserError if another server records into this directory; it cannot while the block runs."""
        descriptor = os.open(self.path, os.O_RDONLY | os.O_CLOEXEC)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError as error:
            raise UserError(f"{self.path}: a server is recording there now; stop it first") from error
        finally:
            os.close(descriptor)

    def keep_experiment(self, experiment: bytes) -> Path:
        """The experiment file as it is run; in a run that goes on it is there."""
        kept = self.path / EXPERIMENT
        if self.is_new:
            kept.write_bytes(experiment)
        return kept

    def log(self, trial: int, part: int = 1) -> Path:
        """Where a part of a trial's log is, once it is closed."""
        later = "" if part == 1 else f"-{part}"
        return self.path / f"{trial_name(trial)}{later}.mcap"

    def logs(self, trial: int) -> list[Path]:
        """The parts of a trial's log that are there, in order."""
        return [self.log(trial, part) for part in self._parts(trial)]

    def next_part(self, trial: int) -> int:
        """The number of the part that is written next."""
        return max(self._parts(trial), default=0) + 1

    def close_logs(self) -> None:
        """Close the logs that an earlier server left open."""
        for left in sorted(self.path.glob(f"trial-*.mcap{OPEN_SUFFIX}")):
            close_log(left)

    def set_aside(self, trial: int) -> None:
        """Give the logs of a trial that is simulated anew names under which nobody takes them for its own."""
        for log in self.logs(trial):
            number = 1
            while (aside := log.with_suffix(f".interrupted-{number}.mcap")).exists():
                number += 1
            log.rename(aside)

    def _parts(self, trial: int) -> list[int]:
        pattern = re.compile(rf"{trial_name(trial)}(?:-(\d+))?\.mcap")
        matches = map(pattern.fullmatch, os.listdir(self.path))
        return sorted(int(match[1] or 1) for match in matches if match)

    def output(self, trial: int) -> Path:
        """Where the processes of a trial print to."""
        return self.path / "output" / trial_name(trial)

    @property
    def emergency(self) -> Path:
        """There while an emergency stop is in force."""
        return self.path / "estop"

    @contextmanager
    def reached_at(self, endpoint: str) -> Iterator[None]:
        """Say where the server listens, for as long as it does."""
        file = self.path / ENDPOINT
        file.write_text(f"{endpoint}\n", encoding="utf-8")
        try:
            yield
        finally:
            file.unlink(missing_ok=True)

    def reserve(self) -> None:
        """Take room now for what is written once there is none: how the run ended."""
        self._reserve.write_bytes(bytes(RESERVED_BYTES))

    def release(self) -> None:
        """Give the room back."""
        self._reserve.unlink(missing_ok=True)

    def remove(self) -> None:
        """Leave nothing of a run that never began; what another server left stays."""
        self.release()
        if self.is_new:
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
