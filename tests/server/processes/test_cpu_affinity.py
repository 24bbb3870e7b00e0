"""Processes of a lockstep keep to their cores and do not interrupt each other; others are left alone."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from server.processes.cpu_affinity import CAN_CHOOSE, keeping_to, keeping_to_share, share, spread
from swarm.parallel import available_cores

REPORT = "import os; print(sorted(os.sched_getaffinity(0)), os.sched_getscheduler(0))"


def test_what_is_started_inside_keeps_to_the_core_and_waits_for_its_turn() -> None:
    before = os.sched_getaffinity(0), os.sched_getscheduler(0)
    core = available_cores()[0]
    with keeping_to(core):
        said = subprocess.run([sys.executable, "-c", REPORT], capture_output=True, text=True, check=True)
    assert said.stdout.split("] ")[0] == f"[{core}"
    assert int(said.stdout.split("] ")[1]) == os.SCHED_BATCH
    assert (os.sched_getaffinity(0), os.sched_getscheduler(0)) == before


def test_the_server_counts_as_two_processes_on_the_first_core() -> None:
    assert spread(4, [0, 1]) == [1, 1, 1, 0]
    assert spread(5, [0, 1, 2]) == [2, 2, 2, 1, 1]
    assert spread(3, [5]) == [5, 5, 5]


def test_trials_side_by_side_have_cores_of_their_own() -> None:
    assert [share([0, 1, 2, 3, 4], number, 2) for number in range(3)] == [[0, 2, 4], [1, 3], [0, 2, 4]]
    assert [share([4, 5], number, 3) for number in range(3)] == [[4], [5], [4]]
    assert share([7], 5, 8) == [7]


@pytest.mark.skipif(not CAN_CHOOSE, reason="this system lets nobody choose")
def test_a_share_is_given_back() -> None:
    before = available_cores()
    with keeping_to_share(0, len(before)):
        assert available_cores() == before[:1]
    assert available_cores() == before
