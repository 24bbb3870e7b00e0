"""The spool: what was put is there for the next start, whatever became of the process or the disk."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from swarm.messages.header import Header, Item
from swarm.runtime.spool import FILE_BYTES, Spool


def item(number: int, epoch: int = 5, size: int = 20) -> Item:
    return Item("robot/r0/move", Header(epoch, number, number * 100), bytes([number % 256]) * size)


def spool(place: Path, run_id: str = "run") -> Spool:
    return Spool(place / "state", "r0", run_id, pytest.fail)


def test_what_was_put_is_left_for_the_next_starts(tmp_path: Path) -> None:
    first = spool(tmp_path)
    assert (first.left, first.epochs) == ([], set())
    for number in range(1, 4):
        first.put(item(number))
    second = spool(tmp_path)
    second.put(item(1, epoch=6))
    third = spool(tmp_path)
    assert third.left == [item(1), item(2), item(3), item(1, epoch=6)]
    assert third.epochs == {5, 6}
    for each in (first, second, third):
        each.close()
        each.close()


@pytest.mark.parametrize("cut", [1, 5, 20])
def test_a_torn_record_goes_and_the_spool_goes_on(tmp_path: Path, cut: int) -> None:
    first = spool(tmp_path)
    for number in range(1, 4):
        first.put(item(number))
    first.close()
    (path,) = (tmp_path / "state").iterdir()
    os.truncate(path, path.stat().st_size - cut)
    second = spool(tmp_path)
    assert second.left == [item(1), item(2)]
    second.put(item(3))
    second.close()
    third = spool(tmp_path)
    assert third.left == [item(1), item(2), item(3)]
    third.close()


def test_it_is_bounded_and_the_oldest_go(tmp_path: Path) -> None:
    first = spool(tmp_path)
    size = FILE_BYTES // 10
    for number in range(1, 41):
        first.put(item(number, size=size))
    first.close()
    sizes = [path.stat().st_size for path in (tmp_path / "state").iterdir()]
    assert sum(sizes) <= 2 * (FILE_BYTES + size + 100)
    second = spool(tmp_path)
    numbers = [each.header.sequence for each in second.left]
    assert numbers == list(range(numbers[0], 41))
    assert len(numbers) >= 10
    second.close()


def test_another_run_s_spool_goes(tmp_path: Path) -> None:
    first = spool(tmp_path)
    first.put(item(1))
    first.close()
    other = spool(tmp_path, run_id="other")
    assert other.left == []
    other.close()
    assert [path.name for path in (tmp_path / "state").iterdir()] == ["r0.other.spool"]


def test_a_full_disk_is_told_of_once_and_stops_nobody(tmp_path: Path) -> None:
    told: list[str] = []
    full = Spool(tmp_path, "r0", "run", told.append)
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
    try:
        for number in range(1, 10):
            full.put(item(number))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    assert told == [
        "warning: what is sent is not kept on this disk: File too large; free some space, or write elsewhere"
    ]
    full.close()


KILLED = """
import os, signal, sys
from pathlib import Path
from tests.swarm.runtime.test_spool import item, spool
kept = spool(Path(sys.argv[1]))
for number in range(1, 1001):
    kept.put(item(number))
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_process_has_lost_nothing_that_it_put(tmp_path: Path) -> None:
    killed = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    assert killed.returncode == -signal.SIGKILL
    after = spool(tmp_path)
    assert after.left == [item(number) for number in range(1, 1001)]
    after.close()
