"""What an agent costs a board: resident memory at work, and the CPU time of its import.

`python -m tests.benchmarks.agent_size` prints one JSON line.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

from server.hubs.lockstep import LockstepHub
from server.processes.supervisor import ProcessSpec, Supervisor
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.benchmarks.processes import resident_mib
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, write_experiment

TICKS = 200


def agent_size() -> dict[str, float]:
    """Resident memory of one learner's process after some ticks of a lockstep."""
    endpoint = free_endpoint()
    with tempfile.TemporaryDirectory() as directory:
        file = write_experiment(Path(directory), experiment_text(learners(1, given=True)))
        arguments = (str(file), "--connect", endpoint, "--lockstep", "--process", "a", "--robot", "r0")
        spec = ProcessSpec("a", "robot_agent", arguments)
        with (
            Session(SessionSettings(endpoint, hub=True)) as session,
            Supervisor([spec], Path(directory) / "output") as supervisor,
        ):
            claim(session, Presence("server", "server", "here", 1))
            hub = LockstepHub(session, ["a"], 0.1, supervisor.check, print)
            hub.start()
            for _ in range(TICKS):
                hub.advance()
                hub.gather()
            size = resident_mib(supervisor.pids["a"])
            hub.finish()
    return {"resident_mib": round(size, 1)}


def import_cost(repeats: int = 3) -> dict[str, float]:
    """CPU time in seconds of a new interpreter's imports, less that of an interpreter alone."""
    alone = _cpu_s("pass", repeats)
    return {
        "agent_cpu_s": round(
            _cpu_s("import robot_agent.main, swarm.runtime.zenoh_session, zenoh", repeats) - alone, 3
        ),
        "numpy_cpu_s": round(_cpu_s("import numpy", repeats) - alone, 3),
    }


def _cpu_s(statement: str, repeats: int) -> float:
    code = f"{statement}\nimport time\nprint(time.process_time())"
    runs = [
        subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
        for _ in range(repeats)
    ]
    return median(float(run.stdout) for run in runs)


if __name__ == "__main__":
    print(json.dumps({**agent_size(), **import_cost()}))
