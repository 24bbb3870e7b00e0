"""A server that is watched while it runs: what it shows on a terminal, and the processes it started."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from tests.support.swarm_runs import ROOT, server_command

PATIENCE_S = 60.0
"""Nothing here takes this long unless it hangs."""


@dataclass(frozen=True)
class Child:
    """One process of a run, held so that its end can be waited for."""

    pid: int
    handle: int

    def ended(self, within_s: float = PATIENCE_S) -> bool:
        """Wait for its end; False if it hangs."""
        return _is_readable(self.handle, within_s)


@dataclass
class WatchedServer:
    """`swarm-server` on a terminal of its own, as a context manager that leaves no process behind."""

    experiment: Path
    out: Path
    options: tuple[str, ...] = ()
    shown: str = ""
    """What has come on the terminal."""
    children: dict[str, Child] = field(default_factory=dict)

    def __enter__(self) -> WatchedServer:
        self._terminal, terminal_end = pty.openpty()
        self.process = subprocess.Popen(
            server_command(self.experiment, self.out, *self.options),
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=terminal_end,
            env={**os.environ, "TERM": "xterm", "COLUMNS": "200"},
        )
        os.close(terminal_end)
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()
        for child in self.children.values():
            if not _is_readable(child.handle, 0.0):
                os.kill(child.pid, signal.SIGKILL)
            os.close(child.handle)
        os.close(self._terminal)

    def wait_for(self, text: str) -> None:
        """Read the terminal until a text has come."""
        while text not in self.shown:
            assert self._read(), f"{text!r} did not come; this did: {self.shown[-2000:]}"

    def wait_for_more(self, text: str) -> None:
        """Read the terminal until a text has come once more."""
        self.shown = ""
        self.wait_for(text)

    def wait_until_under_way(self) -> None:
        """Until the progress bar shows learning, and with it that the log was flushed."""
        self.wait_for(", path:")
        self._find_children()

    def finish(self) -> int:
        """Read to the end; the exit code."""
        while self._read():
            pass
        return self.process.wait(PATIENCE_S)

    def _read(self) -> bool:
        if not _is_readable(self._terminal, PATIENCE_S):
            return False
        try:
            piece = os.read(self._terminal, 65536)
        except OSError:
            return False
        self.shown += piece.decode(errors="replace")
        return bool(piece)

    def _find_children(self) -> None:
        """The processes that name the server as their parent, by the names in their command lines."""
        tasks = Path(f"/proc/{self.process.pid}/task").iterdir()
        for pid in {int(pid) for task in tasks for pid in (task / "children").read_text().split()}:
            words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
            self.children[words[words.index("--process") + 1]] = Child(pid, os.pidfd_open(pid))


def _is_readable(handle: int, wait_s: float) -> bool:
    return bool(select.select([handle], [], [], wait_s)[0])
