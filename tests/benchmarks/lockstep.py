"""The lockstep with empty agents, as a ratio to a bare Unix-socket lockstep of the same shape.

Ten processes each answer every tick; the real hub, link, bus and supervisor against `socket` and `epoll`:
as anyone would write it, then kept to cores, and then also with processes that do not interrupt each other,
as ours. All stand ready at once and take turns, so that a busy machine is as bad for each.
`python -m tests.benchmarks.lockstep` prints one JSON line.
"""

from __future__ import annotations

import argparse
import json
import os
import select
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from server.hubs.lockstep import LockstepHub
from server.processes.cpu_affinity import available_cores, keeping_to, spread
from server.processes.environment import socket_endpoint
from server.processes.supervisor import ProcessSpec, Supervisor
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.lockstep import LockstepNode, patient
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.benchmarks.processes import cpu_of

MODULE = "tests.benchmarks.lockstep"
FRAME_BYTES = 128
TICK_S = 0.1

Advance = Callable[[int], None]


@dataclass(frozen=True)
class Schedule:
    """Whether hub and processes keep to a core each, and how the kernel lets them take turns."""

    kept: bool
    policy: int


SCHEDULES = {
    "bare": Schedule(False, os.SCHED_OTHER),
    "bare_kept_to_cores": Schedule(True, os.SCHED_OTHER),
    "bare_scheduled_as_ours": Schedule(True, os.SCHED_BATCH),
}


def zenoh_worker(name: str, endpoint: str) -> None:
    """An agent process without agents."""
    with Session(patient(SessionSettings(endpoint))) as session:
        LockstepNode(session, name).run(no_step)


def no_step(t_ns: int) -> None:
    """What an empty agent does at a tick."""


def bare_worker(path: str) -> None:
    """Answers every frame with a frame until the other end closes."""
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(path)
        while frame := connection.recv(FRAME_BYTES):
            connection.sendall(frame)


class BareHub:
    """The floor: one frame to each process, one frame back."""

    def __init__(self, path: str, processes: int) -> None:
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(path)
        self._listener.listen(processes)
        self._processes = processes
        self._connections: dict[int, socket.socket] = {}
        self._poll = select.epoll()

    def start(self) -> None:
        for _ in range(self._processes):
            connection, _ = self._listener.accept()
            self._connections[connection.fileno()] = connection
            self._poll.register(connection.fileno(), select.EPOLLIN)

    def advance(self, ticks: int) -> None:
        frame = bytes(FRAME_BYTES)
        for _ in range(ticks):
            for connection in self._connections.values():
                connection.sendall(frame)
            waiting = len(self._connections)
            while waiting:
                for handle, _ in self._poll.poll():
                    self._connections[handle].recv(FRAME_BYTES)
                    waiting -= 1

    def close(self) -> None:
        for connection in (*self._connections.values(), self._listener):
            connection.close()
        self._poll.close()


def bare_specs(path: str, processes: int, kind: str) -> list[ProcessSpec]:
    return [ProcessSpec(f"{kind}-{n}", MODULE, ("--worker", "bare", path)) for n in range(processes)]


def zenoh_specs(endpoint: str, processes: int) -> list[ProcessSpec]:
    names = [f"robots-{number}" for number in range(processes)]
    return [ProcessSpec(name, MODULE, ("--worker", "zenoh", endpoint, name)) for name in names]


def ticks_per_s(advance: Advance, ticks: int) -> float:
    began_s = time.perf_counter()
    advance(ticks)
    return ticks / (time.perf_counter() - began_s)


def zenoh_advance(hub: LockstepHub) -> Advance:
    def advance(ticks: int) -> None:
        for _ in range(ticks):
            hub.advance()
            hub.gather()

    return advance


def measure(processes: int, rounds: int, ticks: int) -> dict[str, object]:
    """All with their processes alive, a piece of each in turn."""
    cores = available_cores()
    with ExitStack() as stack:
        directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        endpoint = stack.enter_context(socket_endpoint())
        stack.enter_context(keeping_to(cores[0]))
        session = stack.enter_context(Session(patient(SessionSettings(endpoint, hub=True))))
        claim(session, Presence("server", "server", "here", 1))
        specs = zenoh_specs(endpoint, processes)
        agents = stack.enter_context(Supervisor(specs, directory / "zenoh", spread(processes, cores)))
        hub = LockstepHub(session, [spec.name for spec in specs], TICK_S, agents.check, print)
        hub.start()
        stack.callback(hub.finish)
        advances = {"zenoh": zenoh_advance(hub)}
        for name, schedule in SCHEDULES.items():
            advances[name] = stack.enter_context(_bare(name, schedule, processes, cores, directory))
        return {"processes": processes, **_rounds(advances, agents.pids, rounds, ticks)}


@contextmanager
def _bare(
    name: str, schedule: Schedule, processes: int, cores: list[int], directory: Path
) -> Iterator[Advance]:
    """A bare lockstep whose hub and processes are scheduled in one way."""
    path = str(directory / f"{name}.socket")
    hub = BareHub(path, processes)
    places = spread(processes, cores)

    def advance(ticks: int) -> None:
        before = os.sched_getaffinity(0), os.sched_getscheduler(0)
        _be_scheduled(0, [cores[0]] if schedule.kept else cores, schedule.policy)
        hub.advance(ticks)
        _be_scheduled(0, *before)

    with Supervisor(bare_specs(path, processes, name), directory / name, places) as workers:
        for pid, place in zip(workers.pids.values(), places, strict=True):
            _be_scheduled(pid, [place] if schedule.kept else cores, schedule.policy)
        hub.start()
        yield advance
        hub.close()


def _be_scheduled(pid: int, cores: Collection[int], policy: int) -> None:
    os.sched_setaffinity(pid, cores)
    os.sched_setscheduler(pid, policy, os.sched_param(0))


def _rounds(advances: dict[str, Advance], pids: dict[str, int], rounds: int, ticks: int) -> dict[str, object]:
    """Rounds of about equal time, so that each has the same chance of an undisturbed one."""
    speeds: dict[str, list[float]] = {name: [] for name in advances}
    pids = {**pids, "hub": os.getpid()}
    worker_s = hub_s = 0.0
    for _ in range(rounds):
        for name, advance in advances.items():
            before = cpu_of(pids)
            speeds[name].append(ticks_per_s(advance, ticks if name == "zenoh" else 3 * ticks))
            if name == "zenoh":
                used = {each: seconds - before[each] for each, seconds in cpu_of(pids).items()}
                hub_s += used.pop("hub")
                worker_s += sum(used.values())
    best = {name: max(values) for name, values in speeds.items()}
    middle = {name: median(values) for name, values in speeds.items()}
    return {
        "ticks_per_s_best": {name: round(value) for name, value in best.items()},
        "ratio_of_best": {name: round(best["zenoh"] / best[name], 3) for name in SCHEDULES},
        "ratio_of_medians": {name: round(middle["zenoh"] / middle[name], 3) for name in SCHEDULES},
        "hub_cpu_us_per_tick": round(1e6 * hub_s / rounds / ticks, 1),
        "process_cpu_us_per_tick": round(1e6 * worker_s / rounds / ticks / (len(pids) - 1), 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worker", nargs="+", help=argparse.SUPPRESS)
    parser.add_argument("--processes", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=25)
    parser.add_argument("--ticks", type=int, default=200)
    arguments = parser.parse_args()
    if arguments.worker:
        kind, *stop = arguments.worker
        bare_worker(stop[0]) if kind == "bare" else zenoh_worker(stop[1], stop[0])
        sys.exit(0)
    print(json.dumps(measure(arguments.processes, arguments.rounds, arguments.ticks)))


if __name__ == "__main__":
    main()
