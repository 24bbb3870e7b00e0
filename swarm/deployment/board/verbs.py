"""A request, and its answer."""

from __future__ import annotations

import json
import signal
import sys
import time
from collections.abc import Callable
from typing import Any

from swarm.deployment.board.activation import activate, go_back
from swarm.deployment.board.installation import install
from swarm.deployment.board.layout import Board
from swarm.deployment.board.machine import look
from swarm.deployment.board.reporting import BoardError, say


def tell_time(board: Board, request: dict[str, Any]) -> dict[str, Any]:
    """This machine's Unix time, at every line that comes."""
    del board, request
    for _ in sys.stdin:
        say("t_ns", time.time_ns())
    return {}


VERBS: dict[str, Callable[[Board, dict[str, Any]], dict[str, Any]]] = {
    "look": look,
    "tell_time": tell_time,
    "install": install,
    "activate": activate,
    "go_back": go_back,
}


def main() -> None:
    """Answer the request in the first line of standard input, also if who asked hangs up meanwhile."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    request = json.loads(sys.stdin.readline())
    try:
        board = Board(request["directory"], request["services"])
        say("result", VERBS[request["verb"]](board, request))
    except BoardError as failure:
        say("error", str(failure))
    except OSError as error:
        say("error", f"{error.filename or ''}: {error.strerror}".removeprefix(": "))
