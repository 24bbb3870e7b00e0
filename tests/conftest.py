"""Fixtures that several test files share: a small run is made once a session."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.support.camera_runs import camera_experiment_text
from tests.support.swarm_runs import experiment_text, run_server, write_experiment


@dataclass(frozen=True)
class SmallRun:
    """A small run in lockstep, with one process a robot."""

    experiment: Path
    directory: Path
    result: dict[str, Any]

    @property
    def log(self) -> Path:
        return self.directory / "trial-000.mcap"


@pytest.fixture(scope="session")
def watching_run(tmp_path_factory: pytest.TempPathFactory) -> SmallRun:
    """A robot that watches another one, and then makes four moves."""
    directory = tmp_path_factory.mktemp("watching")
    experiment = write_experiment(directory, camera_experiment_text(moves=4, names=("expert", "pupil")))
    return SmallRun(experiment, directory / "run", run_server(experiment, directory / "run"))


@pytest.fixture(scope="session")
def small_run(tmp_path_factory: pytest.TempPathFactory) -> SmallRun:
    """Three robots with 30 moves each; tests read the run, and none may change it."""
    directory = tmp_path_factory.mktemp("small")
    experiment = write_experiment(directory, experiment_text())
    return SmallRun(experiment, directory / "run", run_server(experiment, directory / "run"))
