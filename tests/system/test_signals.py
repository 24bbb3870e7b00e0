"""Told to leave at any instant: no process left, no traceback, a log that is closed, and the exit code."""

from __future__ import annotations

import os
import random
import select
import signal
import subprocess
import threading
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest

from swarm.logs.reader import LogReader
from tests.support.laboratory import Laboratory
from tests.support.swarm_runs import ROOT, experiment_text, server_command, write_experiment

LONG = 1_000_000
MADE_BYTES = 4096
"""How a log was made takes 1 kB or less; an exchange of the robots' messages, some kB more."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
LATEST_S = 3.0
"""By then a run of three robots is well under way."""
LABORATORY = ("server", "tracker", "agent")


@dataclass(frozen=True)
class Telling:
    """Which signal comes when, and how the server was called."""

    number: signal.Signals
    after_s: float
    options: tuple[str, ...]


def tellings(count: int, seed: int) -> list[Telling]:
    """Instants from the start of our own code on: half of them while everything is being started."""
    chosen = random.Random(seed)
    found = []
    for number in range(count):
        latest_s = LATEST_S if number % 2 else LATEST_S / 3
        after_s = chosen.uniform(0.0, latest_s)
        options = ((), ("--speed", "20"))[number // 2 % 2]
        found.append(Telling(chosen.choice(SIGNALS), after_s, options))
    return found


def left_behind(marker: str) -> list[str]:
    """The command lines of processes that name the run."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().decode(errors="replace").replace("\0", " ")
            except OSError:
                continue
            if marker in words and int(entry.name) != os.getpid():
                found.append(words)
    return found


def check_leaving(telling: Telling, directory: Path) -> None:
    experiment = write_experiment(directory, experiment_text(moves=LONG))
    out = directory / "run"
    server = subprocess.Popen(
        server_command(experiment, out, *telling.options),
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    wait_until_ours(server)
    threading.Event().wait(telling.after_s)
    server.send_signal(telling.number)
    said = server.communicate()[1]
    assert_left(server.returncode, telling.number, said)
    assert not left_behind(str(directory)), telling
    for output in out.glob("output/*/*.log"):
        assert "Traceback" not in output.read_text(), (telling, output.read_text())
    assert_closed(out)


def wait_until_ours(process: subprocess.Popen[str]) -> None:
    """Until Python has come to our code, which catches SIGTERM at once; what it does before is not ours."""
    caught = 0
    while not caught & 1 << signal.SIGTERM - 1:
        assert process.poll() is None
        status = Path(f"/proc/{process.pid}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        os.sched_yield()


def assert_left(code: int, number: signal.Signals, said: str) -> None:
    assert code in (128 + number, -number), (number, said)
    assert "Traceback" not in said, (number, said)


def assert_closed(run: Path) -> None:
    """Every log of a run has its index, and all messages that it says it has."""
    for log in run.glob("*.mcap"):
        reader = LogReader(log)
        for _ in reader.parts():
            pass
        assert not reader.damage, reader.damage
        assert reader.recorded_messages == reader.messages


@pytest.mark.parametrize("telling", tellings(6, seed=1), ids=str)
def test_a_run_leaves_nothing_behind_whenever_it_is_told_to_leave(telling: Telling, tmp_path: Path) -> None:
    check_leaving(telling, tmp_path)


@pytest.mark.faults
@pytest.mark.parametrize("telling", tellings(100, seed=2), ids=str)
def test_a_hundred_instants(telling: Telling, tmp_path: Path) -> None:
    check_leaving(telling, tmp_path)


@dataclass(frozen=True)
class Parting:
    """Which signal ends a laboratory, and when it comes to its server, its tracker and its agent."""

    number: signal.Signals
    after_s: tuple[float, ...]


def partings(count: int, seed: int) -> list[Parting]:
    chosen = random.Random(seed)
    latest = [LATEST_S if number % 2 else LATEST_S / 3 for number in range(count)]
    return [
        Parting(chosen.choice(SIGNALS), tuple(chosen.uniform(0.0, latest_s) for _ in LABORATORY))
        for latest_s in latest
    ]


def check_parting(parting: Parting, directory: Path) -> None:
    """Each of the three leaves when it is told to, whoever of the others is there, gone, or not yet there."""
    with ExitStack() as stack:
        laboratory = Laboratory(directory, stack, moves=LONG)
        processes = laboratory.serve(), laboratory.track(), laboratory.agent("r0")
        for process in processes:
            wait_until_ours(process)
        began_s = time.monotonic()
        for after_s, process in sorted(zip(parting.after_s, processes, strict=True), key=lambda one: one[0]):
            threading.Event().wait(max(0.0, began_s + after_s - time.monotonic()))
            process.send_signal(parting.number)
        for process in processes:
            said = process.communicate()[1]
            assert_left(process.returncode, parting.number, said)
    assert not left_behind(str(directory))
    assert_closed(directory / "run")


@pytest.mark.parametrize("parting", partings(2, seed=3), ids=str)
def test_a_laboratory_leaves_nothing_behind_either(parting: Parting, tmp_path: Path) -> None:
    check_parting(parting, tmp_path)


@pytest.mark.faults
@pytest.mark.parametrize("parting", partings(100, seed=4), ids=str)
def test_a_hundred_instants_of_a_laboratory(parting: Parting, tmp_path: Path) -> None:
    check_parting(parting, tmp_path)


def test_told_twice_it_still_ends_in_order(tmp_path: Path) -> None:
    """Ctrl-C again, while the processes are being ended."""
    experiment = write_experiment(tmp_path, experiment_text(moves=LONG))
    server = subprocess.Popen(
        server_command(experiment, tmp_path / "run"), cwd=ROOT, stderr=subprocess.PIPE, text=True
    )
    log = tmp_path / "run" / "trial-000.mcap.part"
    while not log.exists():
        os.sched_yield()
    server.send_signal(signal.SIGINT)
    while server.poll() is None:
        server.send_signal(signal.SIGINT)
        threading.Event().wait(0.001)
    assert "Traceback" not in server.communicate()[1]
    assert server.returncode in (128 + signal.SIGINT, -signal.SIGINT), "130 in a shell, wherever it came"
    assert not left_behind(str(tmp_path))


@pytest.mark.parametrize("options", [(), ("--speed", "20")], ids=["lockstep", "speed"])
@pytest.mark.parametrize("stopped", [False, True], ids=["running", "stopped"])
def test_a_killed_server_takes_its_processes_with_it(
    options: tuple[str, ...], stopped: bool, tmp_path: Path
) -> None:
    experiment = write_experiment(tmp_path, experiment_text(moves=LONG))
    server = subprocess.Popen(
        server_command(experiment, tmp_path / "run", *options), cwd=ROOT, stderr=subprocess.DEVNULL
    )
    log = tmp_path / "run" / "trial-000.mcap.part"
    while not is_under_way(log):
        os.sched_yield()
    handles = {pid: os.pidfd_open(pid) for pid in children(server.pid)}
    if stopped:
        os.kill(min(handles), signal.SIGSTOP)
    server.kill()
    server.wait()
    for handle in handles.values():
        select.select([handle], [], [])  # Readable at the end of the process, which is not our own child.
        os.close(handle)


def is_under_way(log: Path) -> bool:
    """Whether the log holds more than how it was made: all processes have joined then."""
    return log.exists() and log.stat().st_size > MADE_BYTES


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    tasks = Path(f"/proc/{pid}/task").iterdir()
    return [int(child) for task in tasks for child in (task / "children").read_text().split()]
