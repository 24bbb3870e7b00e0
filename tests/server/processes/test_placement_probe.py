"""A lockstep stays kept to its cores while that is faster, and leaves them while it is not."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass, field

import pytest

from server.processes.cpu_affinity import CAN_CHOOSE, Placement, place
from server.processes.placement_probe import PlacementProbe
from swarm.parallel import available_cores

STANDS = "import sys; print('up', flush=True); sys.stdin.read()"


@dataclass
class Machine:
    """A machine on which an exchange takes so long in each placement; time passes with the exchanges."""

    exchange_s: dict[Placement, float]
    now_s: float = 0.0
    placement: Placement = Placement.KEPT
    spent_s: dict[Placement, float] = field(default_factory=lambda: dict.fromkeys(Placement, 0.0))

    def place(self, placement: Placement) -> None:
        self.placement = placement

    def run(self, probe: PlacementProbe, seconds: float) -> None:
        end_s = self.now_s + seconds
        while self.now_s < end_s:
            self.now_s += self.exchange_s[self.placement]
            self.spent_s[self.placement] += self.exchange_s[self.placement]
            probe.exchanged()

    def share_kept(self) -> float:
        return self.spent_s[Placement.KEPT] / sum(self.spent_s.values())


def machine_and_probe(kept_s: float, free_s: float) -> tuple[Machine, PlacementProbe]:
    machine = Machine({Placement.KEPT: kept_s, Placement.FREE: free_s})
    return machine, PlacementProbe(machine.place, monotonic_s=lambda: machine.now_s)


def test_on_a_quiet_machine_trials_cost_next_to_nothing() -> None:
    machine, probe = machine_and_probe(0.0002, 0.0004)
    machine.run(probe, 60.0)
    assert probe.placement is Placement.KEPT
    assert machine.share_kept() > 0.98


def test_beside_others_it_is_left_to_the_system_within_seconds() -> None:
    machine, probe = machine_and_probe(0.006, 0.0004)
    machine.run(probe, 20.0)
    assert probe.placement is Placement.FREE
    assert machine.spent_s[Placement.FREE] / 20.0 > 0.9


def test_a_collapse_is_noticed_at_once_and_its_end_within_the_longest_term() -> None:
    machine, probe = machine_and_probe(0.0002, 0.0004)
    machine.run(probe, 30.0)
    machine.exchange_s = {Placement.KEPT: 0.006, Placement.FREE: 0.0008}
    machine.run(probe, 0.5)
    assert machine.placement.name == "FREE"
    machine.run(probe, 10.0)
    machine.exchange_s = {Placement.KEPT: 0.0002, Placement.FREE: 0.0004}
    machine.run(probe, 10.0)
    assert machine.placement.name == "KEPT"


def test_a_placement_that_is_no_better_is_not_changed_to() -> None:
    machine, probe = machine_and_probe(0.0004, 0.00038)
    machine.run(probe, 30.0)
    assert machine.share_kept() > 0.95


@pytest.mark.skipif(not CAN_CHOOSE, reason="this system does not let a process choose its cores")
def test_every_thread_of_a_process_is_placed() -> None:
    cores = available_cores()
    with subprocess.Popen(
        [sys.executable, "-c", STANDS], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        place({process.pid: cores[-1]}, cores, Placement.KEPT)
        kept = os.sched_getaffinity(process.pid), os.sched_getscheduler(process.pid)
        place({process.pid: cores[-1]}, cores, Placement.FREE)
        free = os.sched_getaffinity(process.pid), os.sched_getscheduler(process.pid)
        process.communicate(b"")
    assert kept == ({cores[-1]}, os.SCHED_BATCH)
    assert free == (set(cores), os.SCHED_OTHER)


def test_a_process_that_has_ended_is_passed_over() -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        pass
    place({process.pid: available_cores()[0]}, available_cores(), Placement.KEPT)
