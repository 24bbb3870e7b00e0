"""A disk that fills up under a run: it pauses, its log is closed, and it goes on once there is room."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from swarm import open_run
from swarm.checkup.machine import RESERVE_BYTES
from swarm.logs.check import check_log, check_run
from swarm.messages import swarm_pb2 as pb
from tests.support.swarm_runs import experiment_text, messages, write_experiment
from tests.support.watched_server import WatchedServer

DISK_BYTES = RESERVE_BYTES + (40 << 20)
FILLED_BYTES = 30 << 20


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own, a little larger than the reserve."""
    place = tmp_path / "disk"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "none", str(place)], check=True)
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.faults
@pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount")
@pytest.mark.parametrize("options", [(), ("--speed", "20")], ids=["lockstep", "live"])
def test_a_run_pauses_while_the_disk_is_full(disk: Path, tmp_path: Path, options: tuple[str, ...]) -> None:
    experiment = write_experiment(tmp_path, experiment_text(moves=1_000_000))
    run, filler = disk / "run", disk / "filler"
    with WatchedServer(experiment, run, options) as server:
        server.wait_until_under_way()
        filler.write_bytes(bytes(FILLED_BYTES))
        server.wait_for("paused: the disk of")
        first = run / "trial-000.mcap"
        assert check_log(first).faults == []
        before = first.stat().st_size
        filler.unlink()
        server.wait_for("goes on: the disk has room again")
        server.wait_for_more(" h, path:")
        server.process.send_signal(signal.SIGINT)
        assert server.finish() == 130
    assert first.stat().st_size == before
    (found,) = check_run(run)
    assert found.faults == ["the trial was interrupted: the server was ended by SIGINT"]
    moves = open_run(run).table("moves").collect()
    for _, numbers in moves.group_by("robot").agg("number").iter_rows():
        assert sorted(numbers) == list(range(1, len(numbers) + 1))
    second = run / "trial-000-2.mcap"
    assert next(messages(second, "move"), None), "it has gone on"
    phases = {state.phase for _, state in messages(second, "state")} | {
        state.phase for _, state in messages(first, "state")
    }
    assert phases <= {pb.RunState.RUNNING, pb.RunState.PAUSED}
