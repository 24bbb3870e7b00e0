"""Machines of a laboratory as network namespaces of this one, each on a link that can lose packets."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

from tests.support.swarm_runs import ROOT


def can_make_namespaces() -> bool:
    """Whether this user may; tests that need them are skipped elsewhere."""
    return os.geteuid() == 0 and bool(shutil.which("ip")) and Path("/dev/net/tun").exists()


class Star:
    """A hub's namespace, and a namespace for each board; link 0 leads from the hub to this machine itself.

    `tag` keeps the names apart from those of another test. There is one link 0 at a time: a test that needs
    none is `closed`.
    """

    def __init__(self, tag: str, boards: int, stack: ExitStack, *, closed: bool = False) -> None:
        self.hub = f"{tag}-hub"
        self.boards = [f"{tag}-board{number}" for number in range(1, boards + 1)]
        for name in (self.hub, *self.boards):
            _ip("netns", "add", name)
            stack.callback(_ip, "netns", "del", name)
            _ip("-n", name, "link", "set", "lo", "up")
        ends = dict(enumerate(("", *self.boards)))
        self._links = {
            number: self._link(number, end, stack) for number, end in ends.items() if end or not closed
        }

    def hub_address(self, link: int) -> str:
        """The hub's address as it is reached over a link."""
        return f"10.83.{link}.1"

    def lose(self, link: int, share: float) -> None:
        """From now on a link loses so many of its packets, in both directions."""
        pipe = self._links[link].stdin
        assert pipe
        pipe.write(f"{share}\n")
        pipe.flush()

    def _link(self, number: int, far: str, stack: ExitStack) -> subprocess.Popen[str]:
        ends = (self.hub, self.hub_address(number), far, f"10.83.{number}.2")
        process = subprocess.Popen(
            [sys.executable, "-m", "tests.support.lossy_link", *ends, str(number)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        stack.enter_context(process)
        stack.callback(process.kill)
        assert process.stdout
        assert process.stdout.readline() == "ready\n"
        return process


def inside(name: str) -> list[str]:
    """What to put before a command line to run it in a namespace."""
    return ["ip", "netns", "exec", name]


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)
