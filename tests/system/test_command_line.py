"""What every command answers alike: -h, --help, --version; and completion of the verbs."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from swarm.cli.app import app
from tests.support.swarm_runs import ROOT

VERBS = sorted(get_command(app).commands)  # type: ignore[attr-defined]
COMMANDS = (("swarm",), ("robot_agent",), ("tracker_bridge",), ("server",))
TOOLS = (("robot_agent", "calibrate"), ("robot_agent", "collect-copies"))


def asked(*words: str, **environment: str) -> str:
    """What a command that succeeds prints."""
    command = [sys.executable, "-m", *words]
    surroundings = {**os.environ, **environment}
    done = subprocess.run(command, cwd=ROOT, env=surroundings, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.parametrize("words", [*COMMANDS, *TOOLS], ids=" ".join)
def test_help_is_given_for_both_options(words: tuple[str, ...]) -> None:
    text = asked(*words, "-h")
    assert text == asked(*words, "--help")
    assert "sage: " in text


def test_every_verb_gives_help_for_both_options() -> None:
    assert len(VERBS) >= 8
    for verb in VERBS:
        short, long = (CliRunner().invoke(app, [verb, option]) for option in ("-h", "--help"))
        assert (short.exit_code, short.output) == (0, long.output), verb
        assert f" {verb} " in short.output


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_command_tells_the_version(words: tuple[str, ...]) -> None:
    name, version = asked(*words, "--version").split()
    assert name == "swarm-runtime"
    assert version[0].isdigit()


def test_a_shell_completes_verbs() -> None:
    line = {"COMP_WORDS": "swarm re", "COMP_CWORD": "1", "_SWARM_COMPLETE": "complete_bash"}
    assert asked("swarm", **line).split() == ["resume", "reproduce", "recover", "replay"]
