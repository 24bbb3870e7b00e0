"""From a tracking system's packet to the published pose: the real bridge, a real stream, real Zenoh.

`python -m tests.benchmarks.trackers` prints one JSON line: Vicon and NatNet, 100 Hz, 50 robots, 20 s each.
A pose says when the kernel had its packet, its message's header when it was published; both by the
bridge's clock. The share of a CPU is the bridge's. On a machine that is busy with other things, `chrt -f 1`
before the command gives the figures of an idle one.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from contextlib import closing
from pathlib import Path

import numpy as np

from swarm.clock import NS_PER_S, unix_clock
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.runtime.zenoh_session import Inbox, Session, SessionSettings
from tests.benchmarks.processes import cpu_s
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, write_experiment
from tests.support.tracked_swarm import LOOPBACK, free_udp_port
from tracker_bridge.emulators.interface import Emulator
from tracker_bridge.emulators.motion import Circles
from tracker_bridge.emulators.natnet import NatNetEmulator
from tracker_bridge.emulators.vicon import ViconEmulator

ROBOTS = 50
RATE_HZ = 100
FRAMES = 2_000
SETTLING_FRAMES = 200
"""In which the bridge starts, finds its server, and meets every robot."""


def measured(backend: str) -> dict[str, float]:
    """Losses and latencies of one system."""
    endpoint = free_endpoint()
    with tempfile.TemporaryDirectory() as directory:
        tracker = f'[tracker]\nbackend = "{backend}"\nserver = "{LOOPBACK}"\ninterface = "{LOOPBACK}"\n'
        tracker += f"port = {free_udp_port()}\ncommand_port = {free_udp_port()}\n"
        file = write_experiment(Path(directory), experiment_text(learners(ROBOTS), extra=tracker))
        experiment = Experiment.load(file)
        command = [sys.executable, "-m", "tracker_bridge", str(file), "--connect", endpoint]
        with Session(SessionSettings(endpoint, hub=True)) as session:
            inbox = session.inbox(topics.POSE.key(), topics.POSE.delivery, keep_all=True)
            with (
                closing(_emulator(backend, experiment)) as emulator,
                subprocess.Popen(command, cwd=ROOT) as bridge,
            ):
                try:
                    return _served(emulator, experiment, inbox, bridge.pid)
                finally:
                    bridge.terminate()


def _emulator(backend: str, experiment: Experiment) -> Emulator:
    if backend == "vicon":
        return ViconEmulator(experiment, LOOPBACK, experiment.tracker.port)
    return NatNetEmulator(experiment, LOOPBACK, (3, 0))


def _served(emulator: Emulator, experiment: Experiment, inbox: Inbox, bridge: int) -> dict[str, float]:
    """Show frames; those that count begin when the bridge has answered, and some settling later."""
    motion, clock = Circles(experiment, np.random.default_rng(1)), unix_clock()
    latencies_ms: dict[int, list[float]] = {}
    shown_ns: list[int] = []
    used_s = 0.0
    for t_ns in clock.ticks(1 / RATE_HZ):
        _collect(inbox, latencies_ms)
        if latencies_ms and len(shown_ns) == SETTLING_FRAMES:
            used_s = -cpu_s(bridge)
        if len(shown_ns) < SETTLING_FRAMES + FRAMES:
            shown_ns += [clock.now_ns()] if latencies_ms else []
            emulator.show(motion.poses(t_ns), t_ns)
        elif t_ns > shown_ns[-1] + NS_PER_S:
            break
    used_s += cpu_s(bridge)
    began_ns = shown_ns[SETTLING_FRAMES] - NS_PER_S // RATE_HZ // 2
    counted = [each for received_ns, some in latencies_ms.items() if received_ns >= began_ns for each in some]
    return {
        "poses": len(counted),
        "lost": ROBOTS * FRAMES - len(counted),
        "latency_p50_ms": round(float(np.quantile(counted, 0.5)), 3),
        "latency_p99_ms": round(float(np.quantile(counted, 0.99)), 3),
        "latency_max_ms": round(max(counted), 3),
        "cpu": round(used_s * RATE_HZ / FRAMES, 3),
    }


def _collect(inbox: Inbox, latencies_ms: dict[int, list[float]]) -> None:
    """The latencies of the poses that have come, under the time at which each was received."""
    for sample in inbox.poll():
        header = Header.unpack(sample.attachment)
        if header:
            received_ns = pb.Pose.FromString(sample.payload).received_t_ns
            latencies_ms.setdefault(received_ns, []).append((header.t_ns - received_ns) * 1000 / NS_PER_S)


if __name__ == "__main__":
    print(json.dumps({backend: measured(backend) for backend in ("vicon", "natnet")}))
