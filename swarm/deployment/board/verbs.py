"""A request, and its answer."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable
from typing import Any

from swarm.deployment.board.activation import activate, go_back
from swarm.deployment.board.installation import install
from swarm.deployment.board.layout import Board
from swarm.deployment.board.machine import look
from swarm.deployment.board.reporting import BoardError, say

VERBS: dict[str, Callable[[Board, dict[str, Any]], dict[str, Any]]] = {
    "look": look,
    "install": install,
    "activate": activate,
    "go_back": go_back,
}


def main() -> None:
    """Answer the request on standard input. Who asked may hang up: what was begun is done all the same."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    request = json.load(sys.stdin)
    try:
        board = Board(request["directory"], request["services"])
        say("result", VERBS[request["verb"]](board, request))
    except BoardError as failure:
        say("error", str(failure))
    except OSError as error:
        say("error", f"{error.filename or ''}: {error.strerror}".removeprefix(": "))
