"""The lockstep with empty agents, as a ratio to a bare Unix-socket lockstep of the same shape.

Ten processes each answer every tick; the real hub, link, bus and supervisor against `socket` and `epoll`,
pinned to cores as the supervisor does it and left to the scheduler. All stand ready at once and take turns,
so that a busy machine is as bad for each. `python -m tests.benchmarks.lockstep` prints one JSON line.
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
from collections.abc import Callable
from pathlib import Path
from statistics import median

from server.cores import available_cores, keeping_to, spread
from server.lockstep_hub import LockstepHub
from server.stage import socket_endpoint
from server.supervisor import ProcessSpec, Supervisor
from swarm.bus import Bus, BusSettings
from swarm.lockstep import LockstepLink
from swarm.presence import Presence, claim
from tests.benchmarks.processes import cpu_of

MODULE = "tests.benchmarks.lockstep"
FRAME_BYTES = 128
TICK_S = 0.1

Advance = Callable[[int], None]


def zenoh_worker(name: str, endpoint: str) -> None:
    """An agent process without agents."""
    with Bus(BusSettings(endpoint)) as bus:
        for _ in LockstepLink(bus, name).ticks():
            pass


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


def free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def measure(processes: int, rounds: int, ticks: int) -> dict[str, object]:
    """All three with their processes alive, a piece of each in turn."""
    cores = available_cores()
    with (
        tempfile.TemporaryDirectory() as directory,
        socket_endpoint() as endpoint,
        keeping_to(cores[0]),
        Bus(BusSettings(endpoint, hub=True)) as bus,
    ):
        claim(bus, Presence("server", "server", "here", 1))
        specs = zenoh_specs(endpoint, processes)
        pinned_path, free_path = f"{directory}/pinned", f"{directory}/free"
        bare = {path: BareHub(path, processes) for path in (pinned_path, free_path)}
        with (
            Supervisor(specs, Path(directory) / "zenoh", spread(processes, cores)) as agents,
            Supervisor(
                bare_specs(pinned_path, processes, "pinned"), Path(directory) / "p", spread(processes, cores)
            ),
            Supervisor(
                bare_specs(free_path, processes, "free"), Path(directory) / "f", spread(processes, cores)
            ) as unpinned,
        ):
            for pid in unpinned.pids.values():
                os.sched_setaffinity(pid, cores)
                os.sched_setscheduler(pid, os.SCHED_OTHER, os.sched_param(0))
            hub = LockstepHub(bus, [spec.name for spec in specs], TICK_S, agents.check, print)
            hub.start()
            for each in bare.values():
                each.start()
            advances = {
                "zenoh": zenoh_advance(hub),
                "bare": bare[pinned_path].advance,
                "bare_unpinned": bare[free_path].advance,
            }
            result = _rounds(advances, agents.pids, rounds, ticks)
            hub.finish()
            for each in bare.values():
                each.close()
    return {"processes": processes, **result}


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
        "ratio_of_best": round(best["zenoh"] / best["bare"], 3),
        "ratio_of_medians": round(middle["zenoh"] / middle["bare"], 3),
        "ratio_to_unpinned_best": round(best["zenoh"] / best["bare_unpinned"], 3),
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
        kind, *rest = arguments.worker
        bare_worker(rest[0]) if kind == "bare" else zenoh_worker(rest[1], rest[0])
        sys.exit(0)
    print(json.dumps(measure(arguments.processes, arguments.rounds, arguments.ticks)))


if __name__ == "__main__":
    main()
