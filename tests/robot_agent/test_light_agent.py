"""An agent needs the base install alone, little memory, and no time to start."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from server.hubs.lockstep import LockstepHub
from server.processes.supervisor import ProcessSpec, Supervisor
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.benchmarks.agent_size import agent_size, import_cost
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, write_experiment

LAB = (
    "mcap",
    "small_mcap",
    "foxglove_schemas_protobuf",
    "numba",
    "scipy",
    "matplotlib",
    "polars",
    "typer",
    "rich",
    "dask",
    "distributed",
    "cv2",
)
REFUSE_LAB = f"""
import sys

class WithoutLab:
    def __init__(self, finder):
        self._finder = finder

    def __getattr__(self, name):
        return getattr(self._finder, name)

    def find_spec(self, name, *places):
        return None if name.partition(".")[0] in {LAB!r} else self._finder.find_spec(name, *places)

sys.meta_path[:] = map(WithoutLab, sys.meta_path)
"""
BASE_INSTALL = f"{REFUSE_LAB}\nimport runpy\nrunpy.run_module(sys.argv.pop(1), run_name='__main__')\n"


def test_importing_the_agent_loads_nothing_of_the_lab() -> None:
    code = "import sys, json, robot_agent.main; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(done.stdout)}
    assert {"robot_agent", "swarm", "numpy"} <= loaded
    assert not loaded & {*LAB, "server", "tracker_bridge"}
    assert "swarm.analysis" not in done.stdout


def test_the_base_install_starts_the_agent_and_the_bridge() -> None:
    for module in ("robot_agent", "tracker_bridge"):
        command = [sys.executable, "-c", BASE_INSTALL, module, "--help"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "EXPERIMENT.toml" in done.stdout


def test_the_base_install_says_what_the_server_needs() -> None:
    command = [sys.executable, "-c", BASE_INSTALL, "server", "experiment.toml"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.endswith("install it with pip install 'swarm-runtime[lab]'\n")


@pytest.mark.parametrize(
    ("module", "words"),
    [
        ("robot_agent", ("calibrate", "camera", "--frames", ".")),
        ("tracker_bridge", ("detect", "picture.png")),
        ("robot_agent", ("expert.toml", "--robot", "imitator")),
    ],
)
def test_the_base_install_says_what_pictures_need(
    tmp_path: Path, module: str, words: tuple[str, ...]
) -> None:
    (tmp_path / "expert.toml").write_bytes((ROOT / "deploy" / "sim" / "expert.toml").read_bytes())
    command = [sys.executable, "-c", BASE_INSTALL, module, *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1), done.stderr
    assert "cv2" in done.stderr
    assert "pip install 'swarm-runtime[vision]'" in done.stderr


def test_the_base_install_runs_an_agent_for_ticks(tmp_path: Path) -> None:
    experiment = write_experiment(tmp_path, experiment_text(learners(1)))
    (tmp_path / "base_install.py").write_text(REFUSE_LAB + "from robot_agent.main import main\nmain()\n")
    endpoint = free_endpoint()
    command = (str(experiment), "--connect", endpoint, "--lockstep", "--process", "a", "--robot", "r0")
    spec = ProcessSpec("a", "tests.support.run_file", (str(tmp_path / "base_install.py"), *command))
    with (
        Session(SessionSettings(endpoint, hub=True)) as session,
        Supervisor([spec], tmp_path / "output") as supervisor,
    ):
        claim(session, Presence("server", "server", "here", 1))
        hub = LockstepHub(session, ["a"], 0.1, supervisor.check, print)
        hub.start()
        for _ in range(20):
            hub.advance()
            keys = {item.key for item in hub.gather().items}
        hub.finish()
    assert keys >= {"robot/r0/command", "sim/r0/truth"}


def test_an_agent_process_is_small() -> None:
    """At work, with the learner, the memory of ten paths and a session: at most 64 MiB."""
    assert agent_size()["resident_mib"] <= 64.0


def test_the_agent_imports_in_the_time_of_a_few_numpys() -> None:
    """Under 0.5 s on a quiet machine; numpy's own import, a fixed share of it, is the measure here."""
    cost = import_cost()
    assert cost["agent_cpu_s"] < 4 * cost["numpy_cpu_s"], cost
