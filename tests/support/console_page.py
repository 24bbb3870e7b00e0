"""`swarm console` as a person starts it, and one page of it, spoken to as a browser does."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

from websockets.sync.client import ClientConnection, connect

from tests.support.swarm_runs import ROOT


class ConsolePage:
    """A console and a page, which leave with the block."""

    def __init__(self, stack: ExitStack, *words: object) -> None:
        command = [sys.executable, "-m", "swarm", "console", *map(str, words), "--no-browser", "--port", "0"]
        self.process = stack.enter_context(
            subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        )
        stack.callback(self.process.kill)
        self.addresses = self._printed("look")
        if "--steer" in words:
            self.addresses |= self._printed("steer")
        page, _, token = self.addresses.get("steer", self.addresses["look"]).partition("#token=")
        own = {"Origin": page.rstrip("/")}
        self._page: ClientConnection = stack.enter_context(
            connect(f"ws{page[4:]}run", additional_headers=own, max_size=None, open_timeout=None)
        )
        self._page.send(json.dumps({"token": token}))

    def _printed(self, what: str) -> dict[str, str]:
        assert self.process.stdout
        line = self.process.stdout.readline()
        found = re.fullmatch(rf"{what} +(\S+)\n", line)
        assert found, line
        return {what: found[1]}

    def asks(self, **words: Any) -> None:
        self._page.send(json.dumps(words))

    def told(self, kind: str, condition: Callable[[dict[str, Any]], bool] = bool) -> dict[str, Any]:
        """The next message of a kind that is as wanted."""
        while True:
            message: dict[str, Any] = json.loads(self._page.recv())
            if message["kind"] == kind and condition(message):
                return message

    def orders(self, order: str, *robots: str, prompt: int = 0) -> dict[str, Any]:
        """Give an order, and wait for its answer."""
        self.asks(ask="order", order=order, robots=list(robots), prompt=prompt)
        return self.told("answer")
