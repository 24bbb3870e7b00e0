"""Everything that a run leaves behind: one new directory, nothing overwritten."""

from __future__ import annotations

import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from swarm.control.reaching import ENDPOINT
from swarm.errors import NO_ROOM, UserError
from swarm.files import new_folder

EXPERIMENT, MANIFEST = "experiment.toml", "manifest.json"


@dataclass(frozen=True)
class RunDirectory:
    """A run's directory: `experiment.toml`, `manifest.json` (conditions x trials x seeds), `run.json`
    (what differs between two runs of one seed), `trial-000.mcap` and so on, `output/` of the processes.

    Every server that went on with a trial left a log of its own: `trial-000-2.mcap` and so on.
    """

    path: Path
    part: int = 1
    """Which of its trial's logs this server writes, counted from 1."""
    is_new: bool = True
    """Whether no other server has left anything here."""

    @classmethod
    def create(cls, path: Path | None, name: str) -> RunDirectory:
        """A new directory; without a path the first free runs/NAME-001, -002 and so on."""
        chosen = path or _free(Path("runs"), name)
        return cls(new_folder(chosen))

    @classmethod
    def reopened(cls, path: Path, trial: int) -> RunDirectory:
        """The directory of a run that another server began, for the next log of its trial.

        A server that was killed in its first moment left an empty file, which makes room.
        """
        directory = cls(path, is_new=False)
        while directory.log(trial).exists():
            if directory.log(trial).stat().st_size == 0:
                directory.log(trial).unlink()
            else:
                directory = replace(directory, part=directory.part + 1)
        return directory

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

    def log(self, trial: int) -> Path:
        """The log that this server writes."""
        return self.logs(trial)[-1]

    def logs(self, trial: int) -> list[Path]:
        """All logs of a trial up to this server's, in order."""
        name = trial_name(trial)
        later = [f"{name}-{part}.mcap" for part in range(2, self.part + 1)]
        return [self.path / log for log in (f"{name}.mcap", *later)]

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
