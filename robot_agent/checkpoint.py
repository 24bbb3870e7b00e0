"""What a restarted agent goes on from: one JSON file a robot, replaced in one step."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from swarm.errors import UserError

VERSION = 3
"""Of the file's content; 2 did not tell two runs of one experiment apart."""


class OtherRun(Enum):
    """What becomes of what was learnt in another run."""

    REFUSED = "refused"
    FRESH = "fresh"
    """It is kept under another name, and learning begins anew."""
    RESUMED = "resumed"
    """Learning goes on from it."""


@dataclass(frozen=True)
class Saved:
    """A snapshot, and whether it is of the run that goes on."""

    state: Any
    policy: Any
    run_id: str
    same_run: bool

    @property
    def moves(self) -> Any:
        return self.policy.get("moves", "unknown") if isinstance(self.policy, dict) else "unknown"


class Checkpoint:
    """The file of one robot's snapshot; nothing but JSON is ever read.

    `run_id` tells runs apart and `identity`, a fingerprint, experiments and trials, so that no run goes on
    from another's learning unless a person says so.
    """

    def __init__(
        self, directory: Path, robot: str, run_id: str, identity: str, other: OtherRun = OtherRun.REFUSED
    ) -> None:
        self.path = directory / f"{robot}.json"
        self._run_id = run_id
        self._identity = identity
        self._other = other

    def load(self) -> Saved | None:
        """The last saved snapshot, or None to begin anew; UserError for a damaged file or another run's."""
        try:
            saved = self._read()
        except FileNotFoundError:
            return None
        except (OSError, RecursionError, ValueError) as error:
            self._refuse(f"not a checkpoint ({error}); --fresh begins anew and keeps the file", "damaged")
            return None
        if saved.same_run or self._other is OtherRun.RESUMED:
            return saved
        self._refuse(
            f"what was learnt in run {saved.run_id} ({saved.moves} moves), and this is run {self._run_id}: "
            "--fresh begins anew and keeps the file, --resume goes on from it",
            saved.run_id,
        )
        return None

    def save(self, state: int, policy: Any) -> None:
        """Write beside the old file, bring it to the disk, then put it in the old one's place."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        beside = self.path.with_suffix(".part")
        about = {"version": VERSION, "run_id": self._run_id, "identity": self._identity}
        with beside.open("w", encoding="utf-8") as file:
            json.dump({**about, "state": state, "policy": policy}, file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(self.path)

    def _read(self) -> Saved:
        content = json.loads(self.path.read_text(encoding="utf-8"))
        if not isinstance(content, dict) or content.get("version") != VERSION:
            raise ValueError(f"it is not of version {VERSION}")
        try:
            run_id, identity = str(content["run_id"]), str(content["identity"])
            same = (run_id, identity) == (self._run_id, self._identity)
            return Saved(content["state"], content["policy"], run_id, same)
        except KeyError as error:
            raise ValueError(f"{error} is missing") from error

    def _refuse(self, reason: str, name: str) -> None:
        """UserError, or with --fresh the file gets another name."""
        if self._other is not OtherRun.FRESH:
            raise UserError(f"{self.path}: {reason}")
        self.path.rename(self._free_name(name))

    def _free_name(self, name: str) -> Path:
        """Beside the file: `ROBOT.NAME.json`, with a number if there is one already."""
        safe = name if name.isalnum() else "damaged"
        number = 1
        while (path := self.path.with_suffix(f".{safe}{'' if number == 1 else f'-{number}'}.json")).exists():
            number += 1
        return path
