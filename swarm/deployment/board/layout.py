"""Where everything lies on a machine."""

from __future__ import annotations

import fcntl
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from swarm.deployment.board.reporting import BoardError
from swarm.deployment.board.supervised import Supervised
from swarm.deployment.board.systemd import Systemd

COMPLETE = "release.json"
"""Written last: a program or release without it was not finished, and does not count."""


class Board:
    """The directory on this machine, and what starts its services."""

    def __init__(self, directory: str, services: str) -> None:
        self.root = Path.home() / directory
        self.wheels = self.root / "wheels"
        self.programs = self.root / "programs"
        self.releases = self.root / "releases"
        self.services: Systemd | Supervised = Systemd() if services == "systemd" else Supervised(self.root)

    @contextmanager
    def held(self) -> Iterator[None]:
        """One deployment at a time."""
        for folder in (self.wheels, self.programs, self.releases, self.root / "state"):
            folder.mkdir(parents=True, exist_ok=True)
        with (self.root / "deployment.lock").open("a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise BoardError(
                    "another deployment is under way on this machine: wait for its end"
                ) from None
            yield

    def linked(self, name: str) -> str:
        """The release that `current` or `before` names; empty if none."""
        link = self.root / name
        return link.resolve().name if (link / COMPLETE).exists() else ""

    def link(self, name: str, release: str) -> None:
        """Point `current` or `before` at a release, at once and whole."""
        new = self.root / f".{name}.new"
        new.unlink(missing_ok=True)
        if release:
            new.symlink_to(self.releases / release)
            new.replace(self.root / name)
        else:
            (self.root / name).unlink(missing_ok=True)

    def described(self, release: str) -> dict[str, Any]:
        """What was written when the release was made."""
        if not release:
            return {"services": []}
        found: dict[str, Any] = json.loads((self.releases / release / COMPLETE).read_text())
        return found
