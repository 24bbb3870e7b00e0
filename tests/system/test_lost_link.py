"""A robot whose link is cut again and again, or loses a fifth of its packets: the log has all it learnt."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest

from swarm import open_run
from swarm.logs.check import check_run
from swarm.logs.reader import LogReader
from tests.support.laboratory import quick_text
from tests.support.namespaces import Star, can_make_namespaces, inside
from tests.support.swarm_runs import ROOT, write_experiment

pytestmark = [
    pytest.mark.faults,
    pytest.mark.skipif(not can_make_namespaces(), reason="needs the right to make network namespaces"),
]
CUTS_S = (1.0,) * 12 + (10.0,) * 6 + (60.0,) * 2


@dataclass
class DistantRobot:
    """A server and its tracker in one namespace, a robot in another."""

    place: Path
    star: Star
    stack: ExitStack
    moves: int

    def __post_init__(self) -> None:
        self.file = write_experiment(self.place, quick_text(moves=self.moves))
        listen = ("--listen", "tcp/0.0.0.0:7447", "--out", self.place / "run")
        self.server = self._started(self.star.hub, "server", self.file, *listen)
        self._started(self.star.hub, "tracker_bridge", self.file, "--connect", "tcp/127.0.0.1:7447")
        connect = ("--connect", f"tcp/{self.star.hub_address(1)}:7447", "--robot", "r0")
        state = ("--state", self.place / "state")
        self.agent = self._started(self.star.boards[0], "robot_agent", self.file, *connect, *state)

    def saved(self) -> int:
        """How many moves the robot has made by its own account."""
        try:
            content = json.loads((self.place / "state" / "r0.json").read_text())
        except FileNotFoundError:
            return 0
        return int(content["policy"]["moves"])

    def wait_for(self, moves: int) -> None:
        while self.saved() < moves:
            assert self.server.poll() is None
            self.wait(0.1)

    def wait(self, seconds: float) -> None:
        with pytest.raises(subprocess.TimeoutExpired):
            self.agent.wait(seconds)

    def _started(self, where: str, module: str, *words: object) -> subprocess.Popen[str]:
        command = [*inside(where), sys.executable, "-m", module, *map(str, words), "--insecure"]
        process = subprocess.Popen(
            command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        self.stack.enter_context(process)
        self.stack.callback(process.kill)
        return process


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_a_link_that_is_cut_twenty_times_costs_no_move(stack: ExitStack, tmp_path: Path) -> None:
    rng = random.Random(14)
    cuts_s = rng.sample(CUTS_S, len(CUTS_S))
    robot = DistantRobot(tmp_path, Star("cut", 1, stack, closed=True), stack, moves=100)
    for cut_s in cuts_s:
        robot.wait_for(robot.saved() + 2)
        robot.wait(rng.uniform(0.0, 0.5))
        robot.star.lose(1, 1.0)
        robot.wait(cut_s)
        robot.star.lose(1, 0.0)
    _complete(robot)


def test_a_link_that_loses_a_fifth_costs_no_move(stack: ExitStack, tmp_path: Path) -> None:
    robot = DistantRobot(tmp_path, Star("loss", 1, stack, closed=True), stack, moves=40)
    robot.wait_for(1)
    robot.star.lose(1, 0.2)
    robot.wait_for(40)
    _complete(robot)


def _complete(robot: DistantRobot) -> None:
    _, said = robot.server.communicate()
    assert robot.server.returncode == 0, said
    run = robot.place / "run"
    moves = open_run(run).table("moves").collect()["number"].to_list()
    assert moves == list(range(1, robot.saved() + 1)), "in order, and each once"
    (found,) = check_run(run)
    assert (found.faults, found.holes) == ([], [])
    account = LogReader(run / "trial-000.mcap").read_metadata()["account"]
    of_moves = [json.loads(text) for name, text in account.items() if name.startswith("robot/r0/move")]
    assert [(each["received"], each["lost"]) for each in of_moves] == [(len(moves), 0)]
    print(f"{len(moves)} moves, {of_moves[0]['recovered']} recovered")
