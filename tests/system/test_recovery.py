"""Servers and agents that are killed again and again: no move is missing from the log, or twice in it."""

from __future__ import annotations

import json
import random
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm import open_run
from swarm.logs.check import check_run
from tests.support.laboratory import Laboratory


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def moves_of(run: Path, robot: str) -> list[int]:
    """The numbers of a robot's moves, in the order in which it made them."""
    moves = open_run(run).table("moves").collect().filter(robot=robot)
    return moves.sort("epoch", "sequence")["number"].to_list()


def saved(laboratory: Laboratory, robot: str) -> int:
    """How many moves a robot's checkpoint has."""
    try:
        content = json.loads((laboratory.directory / "state" / f"{robot}.json").read_text())
    except FileNotFoundError:
        return 0
    return int(content["policy"]["moves"])


def wait_until_saved(laboratory: Laboratory, robot: str, moves: int) -> None:
    """A robot without a server hears no poses: it comes to the end of its move."""
    while saved(laboratory, robot) < moves:
        pass


def killed(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait()


def finished(process: subprocess.Popen[str]) -> None:
    _, said = process.communicate()
    assert process.returncode == 0, said


def test_what_a_killed_agent_sent_to_nobody_is_in_the_log(stack: ExitStack, tmp_path: Path) -> None:
    """First the server is killed, then the agent; what it had sent meanwhile only its disk knows."""
    laboratory = Laboratory(tmp_path, stack, moves=14)
    server, agent, _ = laboratory.serve(), laboratory.agent("r0"), laboratory.track()
    laboratory.wait_for_moves("r0", 2)
    killed(server)
    wait_until_saved(laboratory, "r0", saved(laboratory, "r0") + 1)
    killed(agent)
    alone = saved(laboratory, "r0")
    server = laboratory.serve("--resume", tmp_path / "run")
    laboratory.agent("r0")
    finished(server)
    made = moves_of(tmp_path / "run", "r0")
    assert sorted({*made}) == list(range(1, max(made) + 1))
    assert len(made) <= max(made) + 1, "but for one that was told and not yet saved"
    assert set(range(1, alone + 1)) <= set(made)
    assert check_run(tmp_path / "run")[0].faults == []


def kill_servers(laboratory: Laboratory, times: int, rng: random.Random) -> None:
    """Kill a server so many times at random instants of a move or two, each time resuming; then finish."""
    options: tuple[object, ...] = ()
    for _ in range(times):
        server = laboratory.serve(*options)
        options = ("--resume", laboratory.directory / "run")
        laboratory.wait_for_moves("r0", 0)
        with pytest.raises(subprocess.TimeoutExpired):
            server.wait(rng.uniform(0.0, 1.0))
        killed(server)
    finished(laboratory.serve(*options))


@pytest.mark.parametrize(
    ("times", "moves"),
    [pytest.param(2, 30, id="twice"), pytest.param(100, 400, id="a hundred times", marks=pytest.mark.faults)],
)
def test_of_a_server_that_is_killed_no_move_is_missing(
    stack: ExitStack, tmp_path: Path, times: int, moves: int
) -> None:
    laboratory = Laboratory(tmp_path, stack, moves=moves)
    agent, _ = laboratory.agent("r0"), laboratory.track()
    kill_servers(laboratory, times, random.Random(14))
    finished(agent)
    run = tmp_path / "run"
    assert moves_of(run, "r0") == list(range(1, saved(laboratory, "r0") + 1))
    (found,) = check_run(run)
    assert (found.faults, found.holes, found.share) == ([], [], 1.0)
    assert not list(run.glob("*.part"))
