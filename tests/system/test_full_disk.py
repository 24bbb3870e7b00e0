"""A disk that is really full: one line, no traceback, nothing half-written, and robots that go on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.checkup.machine import RESERVE_BYTES
from tests.conftest import SmallRun
from tests.support.laboratory import Laboratory
from tests.support.swarm_runs import ROOT, experiment_text, messages, server_command, write_experiment
from tests.system.test_signals import is_under_way, left_behind

pytestmark = pytest.mark.faults

DISK_BYTES = RESERVE_BYTES + (4 << 20)
"""Four megabytes more than a run must find to begin."""


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


def test_a_simulation_ends_in_order(disk: Path, tmp_path: Path) -> None:
    experiment = write_experiment(tmp_path, experiment_text(moves=1_000_000))
    run = disk / "run"
    server = subprocess.Popen(server_command(experiment, run), cwd=ROOT, stderr=subprocess.PIPE, text=True)
    while not is_under_way(run / "trial-000.mcap"):
        os.sched_yield()
    fill(disk)
    said = server.communicate()[1]
    assert server.returncode == 1
    assert "failed: " in said.splitlines()[-1]
    assert "Traceback" not in said
    states = {trial["state"] for trial in json.loads((run / "manifest.json").read_text())["trials"]}
    assert states == {"interrupted"}
    assert not left_behind(str(experiment))


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
