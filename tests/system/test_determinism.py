"""The same seed gives the same log, byte for byte, however the work is divided and whatever else goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.conftest import SmallRun
from tests.support.swarm_runs import run_server

SPIN = "while True: pass"


@contextmanager
def every_core_busy() -> Iterator[None]:
    """One spinning process a core, ended with the block."""
    spinners = [subprocess.Popen([sys.executable, "-c", SPIN]) for _ in os.sched_getaffinity(0)]
    try:
        yield
    finally:
        for spinner in spinners:
            spinner.kill()
            spinner.wait()


def again(small_run: SmallRun, out: Path, *options: str) -> bytes:
    """The log of a repetition."""
    run_server(small_run.experiment, out, *options)
    return (out / small_run.log.name).read_bytes()


def test_a_repetition_gives_the_same_bytes(small_run: SmallRun, tmp_path: Path) -> None:
    assert small_run.result["moves"] >= 60
    assert again(small_run, tmp_path / "run") == small_run.log.read_bytes()


def test_all_robots_in_one_process_give_the_same_bytes(small_run: SmallRun, tmp_path: Path) -> None:
    assert again(small_run, tmp_path / "run", "--processes", "1") == small_run.log.read_bytes()


def test_a_busy_machine_gives_the_same_bytes(small_run: SmallRun, tmp_path: Path) -> None:
    with every_core_busy():
        assert again(small_run, tmp_path / "run") == small_run.log.read_bytes()


def test_another_seed_gives_another_log(small_run: SmallRun, tmp_path: Path) -> None:
    assert again(small_run, tmp_path / "run", "--seed", "2") != small_run.log.read_bytes()
