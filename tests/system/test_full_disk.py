"""A disk that is really full: one line, no traceback, nothing half-written, and robots that go on."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm import open_run
from swarm.checkup.machine import RESERVE_BYTES
from swarm.logs.check import check_run
from tests.conftest import SmallRun
from tests.support.laboratory import Laboratory
from tests.support.swarm_runs import ROOT, experiment_text, messages, write_experiment
from tests.support.watched_server import WatchedServer
from tests.system.test_signals import left_behind

pytestmark = pytest.mark.faults

DISK_BYTES = RESERVE_BYTES + (40 << 20)
"""Some megabytes more than a run must find to begin, and to go on."""


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(place)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("only root may mount a small file system")
    yield place
    subprocess.run(["umount", "--lazy", str(place)], check=True)


def fill(disk: Path) -> None:
    """Leave not a byte."""
    with (disk / "filling").open("wb", buffering=0) as file:
        try:
            while file.write(bytes(1 << 16)):
                pass
        except OSError:
            return


def command(*words: object) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "swarm", *map(str, words)]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)


def one_line(said: str) -> str:
    (line,) = said.splitlines()
    return line


@pytest.mark.parametrize("options", [(), ("--speed", "20")], ids=["lockstep", "live"])
def test_a_run_pauses_and_goes_on_once_there_is_room(
    disk: Path, tmp_path: Path, options: tuple[str, ...]
) -> None:
    experiment = write_experiment(tmp_path, experiment_text(moves=1_000_000))
    run = disk / "run"
    with WatchedServer(experiment, run, options) as server:
        server.wait_until_under_way()
        fill(disk)
        server.wait_for("paused: ")
        (disk / "filling").unlink()
        server.wait_for("goes on: the disk has room again")
        server.wait_for_more(", path:")
        server.process.send_signal(signal.SIGINT)
        assert server.finish() == 130
        assert "Traceback" not in server.shown
    assert not left_behind(str(experiment))
    (found,) = check_run(run)
    assert found.faults == ["the trial was interrupted: the server was ended by SIGINT"]
    moves = open_run(run).table("moves").collect()
    for _, numbers in moves.group_by("robot").agg("number").iter_rows():
        assert sorted(numbers) == list(range(1, len(numbers) + 1))
    last = sorted(run.glob("trial-000-*.mcap"))[-1]
    assert next(messages(last, "move"), None), "it has gone on"


def test_nothing_half_written_is_left_of_what_a_log_gives(disk: Path, small_run: SmallRun) -> None:
    fill(disk)
    log = small_run.directory / "trial-000.mcap"
    asked = {
        "recover": (log, "--out", disk / "log.mcap"),
        "analyze": (small_run.directory, "--out", disk / "analysis"),
        "export": (log, "--to", "csv", "--out", disk / "tables"),
    }
    for verb, words in asked.items():
        done = command(verb, *words)
        assert done.returncode in (1, 2), (verb, done.stderr)
        assert "No space left on device" in one_line(done.stderr), verb
    assert [path for path in disk.rglob("*") if path.is_file()] == [disk / "filling"]


def test_a_robot_goes_on_although_it_can_keep_nothing(disk: Path, tmp_path: Path) -> None:
    with ExitStack() as stack:
        laboratory = Laboratory(tmp_path, stack, moves=8)
        server = laboratory.serve()
        laboratory.track()
        agent = laboratory.agent("r0", "--state", disk / "state")
        laboratory.wait_for_moves("r0", 1)
        fill(disk)
        assert server.wait() == 0
        said = agent.communicate()[1]
    assert agent.returncode == 0
    assert "Traceback" not in said
    told = [event.text for _, event in messages(tmp_path / "run" / "trial-000.mcap", "event")]
    assert [text for text in told if "what is learnt is not saved: No space left on device" in text]
