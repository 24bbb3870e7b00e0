"""Whose run is this? Nobody takes part in a run that is not theirs, and nothing enters its log."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.messages.topics import Delivery
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.laboratory import Laboratory, line_of, quick_text
from tests.support.swarm_runs import messages, write_experiment


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[Laboratory]:
    """One learner with five moves to make."""
    with ExitStack() as stack:
        yield Laboratory(tmp_path, stack, moves=5)


def finished(server: subprocess.Popen[str]) -> str:
    """What a server that ended well has said."""
    _, said = server.communicate()
    assert server.returncode == 0, said
    return said


def events(log: Path, name: str) -> list[str]:
    """The texts of a log's events of one name."""
    return [event.text for _, event in messages(log, "event") if event.name == name]


def numbers(log: Path, robot: str) -> list[int]:
    """The numbers of a robot's moves, in the order of the log."""
    return [move.number for name, move in messages(log, "move") if name == robot]


def manifest(run: Path) -> Any:
    return json.loads((run / "manifest.json").read_text())


def test_a_run_has_an_id_in_its_files_its_log_and_its_state(laboratory: Laboratory) -> None:
    server = laboratory.serve()
    laboratory.track()
    agent = laboratory.agent("r0")
    finished(server)
    assert line_of_nothing(agent) == ""
    run = laboratory.directory / "run"
    run_id = manifest(run)["run_id"]
    states = [state for _, state in messages(run / "trial-000.mcap", "state")]
    identity = RunIdentity.of(Experiment.load(laboratory.file), 0, run_id)
    assert len(run_id) == 12
    assert {state.run_id for state in states} == {run_id}
    assert {state.identity for state in states} == {str(identity.fingerprint)}
    assert json.loads((run / "run.json").read_text())["run_id"] == run_id
    assert numbers(run / "trial-000.mcap", "r0")[:5] == [1, 2, 3, 4, 5]


def line_of_nothing(process: subprocess.Popen[str]) -> str:
    _, said = process.communicate()
    assert process.returncode == 0, said
    return said
