"""The wheel, installed outside the checkout, in a folder whose files are named like our modules."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.swarm_runs import ROOT, experiment_text, write_experiment

pytestmark = pytest.mark.long

SHADOWS = ("server", "swarm", "robot_agent", "tracker_bridge", "numpy", "random", "struct")
SHADOW = "raise SystemExit(f'{__file__} was imported from the working directory')\n"
PACKAGES = ("swarm", "robot_agent", "tracker_bridge", "server")


@dataclass(frozen=True)
class Installation:
    """A virtual environment with the wheel and the libraries of the tests' interpreter, and a user's
    folder."""

    programs: Path
    folder: Path

    def run(self, *words: str, code: int = 0) -> str:
        """Run a command as a user does, in the folder; what it printed."""
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        program = str(self.programs / words[0])
        done = subprocess.run(
            [program, *words[1:]],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == code, done.stdout + done.stderr
        assert "Traceback" not in done.stderr
        return done.stdout


@pytest.fixture(scope="module")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Installation:
    directory = tmp_path_factory.mktemp("wheel")
    venv.create(directory / "venv", with_pip=False)
    programs = directory / "venv" / "bin"
    _pip("--python", str(programs / "python"), "install", "--no-deps", str(_wheel(directory)))
    site = next((directory / "venv" / "lib").glob("python*/site-packages"))
    libraries = [place for place in sys.path if Path(place).name == "site-packages"]
    (site / "libraries.pth").write_text("\n".join(libraries))
    return Installation(programs, _users_folder(directory / "user"))


def _wheel(directory: Path) -> Path:
    """Built of a copy of the checkout, which keeps no trace of it."""
    source = directory / "source"
    for name in PACKAGES:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "*.nb?"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    _pip("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(directory), str(source))
    return next(directory.glob("*.whl"))


def _pip(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "pip", *words, "--quiet"], cwd=ROOT.parent, check=True)


def _users_folder(folder: Path) -> Path:
    write_experiment(folder, experiment_text())
    shutil.copy(ROOT / "deploy" / "sim" / "expert.toml", folder)
    shutil.copy(ROOT / "deploy" / "cameras" / "epuck_160x120.toml", folder)
    for name in SHADOWS:
        (folder / f"{name}.py").write_text(SHADOW)
    return folder


def test_the_package_is_the_installed_one(installation: Installation) -> None:
    code = "import server, swarm; print(swarm.__file__, server.__file__)"
    for file in installation.run("python", "-P", "-c", code).split():
        assert Path(file).is_relative_to(installation.programs.parent)


@pytest.mark.parametrize("command", ["swarm", "swarm-server", "robot-agent", "tracker-bridge"])
def test_every_command_tells_its_version(installation: Installation, command: str) -> None:
    assert installation.run(command, "--version").startswith("swarm-runtime ")


def test_a_run_is_simulated_and_looked_at(installation: Installation) -> None:
    told = installation.run("swarm", "simulate", "small.toml", "--out", "run", "--json")
    assert json.loads(told.splitlines()[-1])["moves"] >= 60
    assert "complete and sound" in installation.run("swarm", "check", "run/trial-000.mcap")
    assert "report.md" in installation.run("swarm", "analyze", "run")
    assert "wrote durations.csv" in installation.run("swarm", "durations", "run")
    assert "messages" in installation.run("swarm", "recover", "run/trial-000.mcap", "--out", "whole.mcap")
    code = "import swarm; print(swarm.open_run('run').table('moves').collect().height)"
    assert int(installation.run("python", "-P", "-c", code)) >= 60


def test_the_server_is_a_command_too(installation: Installation) -> None:
    told = installation.run("swarm-server", "small.toml", "--out", "second", "--moves", "10")
    assert "swarm analyze second" in told


def test_trials_find_their_data_and_their_workers(installation: Installation) -> None:
    words = ("--trials", "2", "--moves", "300", "--jobs", "2", "--out", "trials", "--json")
    told = json.loads(installation.run("swarm", "trials", "expert.toml", *words))
    assert told["trials"] == 2


def test_figures_are_reproduced_by_workers(installation: Installation) -> None:
    words = ("fig3", "--runs", "4", "--steps", "300", "--jobs", "2", "--out", "figures")
    assert "fig3" in installation.run("swarm", "reproduce", *words)
    assert "fig3" in installation.run("swarm", "claims", *words)


def test_the_agents_tools_run(installation: Installation) -> None:
    camera = ("--camera", "epuck_160x120.toml", "--skirt", "red")
    installation.run("robot-agent", "calibrate", "--simulated", *camera, "--out", "red.npz")
    installation.run("robot-agent", "collect-copies", "--demonstrations", "1", "--out", "copies.csv")
    assert {"red.npz", "copies.csv"} <= {path.name for path in installation.folder.iterdir()}
