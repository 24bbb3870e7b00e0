"""Malformed files and command lines by the hundred: one line, exit code 2, nothing left behind."""

from __future__ import annotations

import io
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TypeVar

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import robot_agent.main
import server.main
import swarm.cli.main
import tracker_bridge.main
from swarm.checkup.checkup import experiment_findings
from swarm.checkup.finding import require_good
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.interpreter import child_environment
from tests.support.malformed import EXPERIMENT, GOOD_FILE, Command, command_lines, experiment_files

MAINS = {
    "swarm": swarm.cli.main.main,
    "server": server.main.main,
    "robot_agent": robot_agent.main.main,
    "tracker_bridge": tracker_bridge.main.main,
}
MANY = settings(
    max_examples=300, derandomize=True, database=None, deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)  # fmt: skip
T = TypeVar("T")


def refusal(file: Path) -> str | None:
    """What is said of a file, or None if it is good."""
    try:
        require_good(file, experiment_findings(Experiment.load(file)))
    except UserError as error:
        return str(error)
    return None


def words_of(command: Command, file: Path) -> list[str]:
    return [str(file) if word == EXPERIMENT else word for word in command.words]


def assert_refused(code: object, out: str, err: str, folder: Path) -> None:
    """One line that starts with `error: `, exit code 2, and nothing beside the experiment's file."""
    assert (code, out, err[:7], err.count("\n")) == (2, "", "error: ", 1), (code, out, err)
    assert err.endswith("\n")
    assert len(err) < 1000
    assert [path.name for path in folder.iterdir()] == ["small.toml"]


def test_the_file_that_is_spoilt_is_good(tmp_path: Path) -> None:
    file = tmp_path / "small.toml"
    file.write_text(GOOD_FILE)
    assert refusal(file) is None


@MANY
@given(content=experiment_files())
def test_a_malformed_file_is_refused_in_one_line(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "small.toml"
    file.write_bytes(content)
    said = refusal(file)
    assume(said is not None)
    assert said is not None
    assert said.startswith(str(file))
    assert said.isprintable()
    assert len(said) < 600 + len(str(tmp_path))


@MANY
@given(command=command_lines())
def test_a_malformed_command_line_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    file = tmp_path / "small.toml"
    file.write_text(GOOD_FILE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [command.module, *words_of(command, file)])
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), pytest.raises(SystemExit) as left:
        MAINS[command.module]()
    assert_refused(left.value.code, out.getvalue(), err.getvalue(), tmp_path)


def examples(strategy: st.SearchStrategy[T], count: int) -> Sequence[T]:
    """So many different ones, the same in every run."""
    found: dict[T, None] = {}

    @settings(max_examples=3 * count, derandomize=True, database=None, deadline=None)
    @given(one=strategy)
    def collect(one: T) -> None:
        found[one] = None

    collect()
    return list(found)[:count]


@pytest.mark.faults
def test_real_processes_refuse_malformed_files_and_command_lines(tmp_path: Path) -> None:
    """150 files, each with every command that takes one in turn, and 150 command lines."""
    takers = (
        ("swarm", "simulate"),
        ("server",),
        ("swarm", "trials"),
        ("robot_agent", "--robot=pupil"),
        ("tracker_bridge",),
    )
    cases: list[tuple[Path, Command]] = []
    for number, content in enumerate(examples(experiment_files(), 200)):
        file = _file(tmp_path / f"file-{number}", content)
        if refusal(file) is not None:
            module, *words = takers[number % len(takers)]
            cases.append((file, Command(module, (*words, EXPERIMENT))))
    cases = cases[:150]
    for number, command in enumerate(examples(command_lines(), 150)):
        cases.append((_file(tmp_path / f"line-{number}", GOOD_FILE.encode()), command))
    assert len(cases) > 250
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(_assert_refused_by_a_process, cases))


def _file(folder: Path, content: bytes) -> Path:
    folder.mkdir()
    file = folder / "small.toml"
    file.write_bytes(content)
    return file


def _assert_refused_by_a_process(case: tuple[Path, Command]) -> None:
    file, command = case
    words = [sys.executable, "-m", command.module, *words_of(command, file)]
    done = subprocess.run(
        words, cwd=file.parent, env=child_environment(), capture_output=True, text=True, check=False,
        errors="replace",
    )  # fmt: skip
    assert_refused(done.returncode, done.stdout, done.stderr, file.parent)
