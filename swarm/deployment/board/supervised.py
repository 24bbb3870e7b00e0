"""Services under this package's supervisor, on a machine without systemd."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

from swarm.deployment.board.reporting import BoardError
from swarm.deployment.board.waiting import until

LARGEST_LOG_BYTES = 10_000_000
"""A service's output is put aside at its next start, and replaces what was put aside before."""
STOP_WITHIN_S = 90.0
"""More than any unit's TimeoutStopSec, in which supervisor and systemd end a process themselves."""


class Supervised:
    """Services under this package's supervisor, on a machine without systemd."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._states = root / "services"
        self._logs = root / "log"

    def install(self, release: Path) -> None:
        """Units are read where they lie."""
        del release
        self._states.mkdir(exist_ok=True)
        self._logs.mkdir(exist_ok=True)

    def restart(self, name: str) -> None:
        """End what runs, and start a supervisor that outlives this program."""
        self.stop(name)
        unit, _, instance = name.removesuffix(".service").partition("@")
        file = f"{unit}@.service" if instance else f"{unit}.service"
        current = self._root / "current"
        words: list[str | Path] = [
            current / "program" / "bin" / "python",
            "-I",
            "-m",
            "swarm.services.supervisor",
        ]
        words += [current / "units" / file, instance, self._state_file(name)]
        self._state_file(name).write_text(json.dumps({"state": "starting"}))
        with self._log(name).open("ab") as log:
            subprocess.Popen(
                words, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True, cwd="/"
            )

    def stop(self, name: str) -> None:
        """End a service and its supervisor."""
        if not until(lambda: not self._told_to_end(name), STOP_WITHIN_S):
            raise BoardError(f"{name} does not end")

    def _told_to_end(self, name: str) -> bool:
        """Whether there is a supervisor yet; it knows now that it should end."""
        pid = self._supervisor(name)
        if pid:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGTERM)
        return bool(pid)

    def state(self, name: str) -> str:
        """active, starting, or what else it is."""
        try:
            state = str(json.loads(self._state_file(name).read_text())["state"])
        except FileNotFoundError:
            return "inactive"
        if state in ("active", "restarting") and not self._supervisor(name):
            return "ended"
        return state

    def last_words(self, name: str) -> str:
        """The last line that a service has printed."""
        lines = self._log(name).read_text(errors="replace").splitlines()
        return lines[-1] if lines else ""

    def _supervisor(self, name: str) -> int:
        """The process id of a service's supervisor, which holds a lock while it lives; 0 if there is none."""
        try:
            with self._state_file(name).with_suffix(".lock").open() as lock:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except FileNotFoundError:
            return 0
        except OSError:
            return int(self._state_file(name).with_suffix(".lock").read_text() or 0)
        return 0

    def _state_file(self, name: str) -> Path:
        return self._states / f"{name.removesuffix('.service')}.json"

    def _log(self, name: str) -> Path:
        log = self._logs / f"{name.removesuffix('.service')}.log"
        if log.exists() and log.stat().st_size > LARGEST_LOG_BYTES:
            log.replace(log.with_suffix(".1"))
        return log
