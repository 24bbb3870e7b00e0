"""A laboratory on one machine, at the pace of life: the three commands, as people start them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from swarm.messages import topics
from swarm.messages.topics import Delivery, Topic, topic_of
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, write_experiment

CONNECTION = ("waiting for the server", "connected to", "lost the server", "resumed: the server")
SMALL_AND_QUICK = """cell_m = 0.05
columns = 2
rows = 2
[learning]
epsilon = 1.0
rest_s = 0.0
blocked_move_s = 0.0
"""
"""Half of the choices lead into a wall and take no time, the others half a second."""


def quick_text(count: int = 1, moves: int = 1000) -> str:
    """An experiment of learners that make some moves a second."""
    return experiment_text(learners(count), moves, SMALL_AND_QUICK)


class Laboratory:
    """The processes of one place, none of which outlives the block."""

    def __init__(self, directory: Path, stack: ExitStack, count: int = 1, moves: int = 1000) -> None:
        self.directory = directory
        self.endpoint = free_endpoint()
        self.file = write_experiment(directory, quick_text(count, moves))
        self._stack = stack
        self._watcher: Session | None = None

    def serve(self, *options: object, file: Path | None = None) -> subprocess.Popen[str]:
        """`swarm-server`, recording into `run` unless the options say otherwise."""
        given = ("--out", self.directory / "run") if not {"--out", "--resume"} & set(options) else ()
        named = () if "--resume" in options else (file or self.file,)
        return self._started("server", *named, "--listen", self.endpoint, *given, *options)

    def track(self, *options: object) -> subprocess.Popen[str]:
        """`tracker-bridge`."""
        return self._started("tracker_bridge", self.file, "--connect", self.endpoint, *options)

    def agent(self, robot: str, *options: object, file: Path | None = None) -> subprocess.Popen[str]:
        """`robot-agent`, with its state in `state`."""
        words = (file or self.file, "--connect", self.endpoint, "--robot", robot)
        return self._started("robot_agent", *words, "--state", self.directory / "state", *options)

    def heard(self, topic: Topic[Any]) -> Iterator[tuple[str, Any]]:
        """Robot and message of everything of a topic that is sent from now on."""
        if self._watcher is None:
            self._watcher = self._stack.enter_context(Session(SessionSettings(self.endpoint)))
        inbox = self._watcher.inbox(topic.key(), Delivery.EVERY)
        while True:
            for sample in inbox.poll():
                found = topic_of(sample.key)
                if found:
                    yield found[1], topic.message.FromString(sample.payload)

    def wait_for_moves(self, robot: str, number: int) -> None:
        """Until a robot has made so many moves."""
        for name, move in self.heard(topics.MOVE):
            if name == robot and move.number >= number:
                return

    def _started(self, module: str, *words: object) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-m", module, *map(str, words)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "COLUMNS": "1000"},
        )
        self._stack.enter_context(process)
        self._stack.callback(process.kill)
        return process


def line_of(process: subprocess.Popen[str], code: int) -> str:
    """The one line that a process leaves with; what it told of its connection before stands above it."""
    _, said = process.communicate()
    assert process.returncode == code, said
    *above, line = said.splitlines()
    assert all(before.startswith(CONNECTION) for before in above), said
    return line
