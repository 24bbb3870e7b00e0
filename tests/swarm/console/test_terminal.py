"""A run in the terminal."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.console.terminal import clock, run_table
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from tests.support.console_logs import history_of
from tests.support.small_logs import SmallLog, metadata
from tests.support.swarm_runs import ROOT

LOSS = "imitator: no believable pose for 2 s"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A learner whose path becomes shorter, and an event whose cure is known."""
    text = (ROOT / "deploy" / "sim" / "demo.toml").read_text()
    log = SmallLog(tmp_path / "trial-000.mcap", {**metadata(), "experiment": {"toml": text}})
    log.add("run/state", pb.RunState(phase=pb.RunState.RUNNING))
    for number in range(1, 31):
        for robot in ("loner", "imitator"):
            log.add(f"robot/{robot}/move", pb.Move(number=number, state=0, action=0, next_state=1))
        if number % 10 == 0:
            log.add(
                "robot/imitator/best_path", pb.BestPath(move=number, length=100 // (number // 10), cap=100)
            )
    log.add("tracker/event", pb.Event(level=pb.Event.WARNING, name="lost", text=LOSS))
    log.add("robot/imitator/status", pb.Status(activity="moving", moves=30, battery_v=3.7))
    return log.close()


def shown(log: Path, t_s: float | None = None) -> str:
    history = history_of(log)
    screen = Console(file=StringIO(), width=160)
    screen.print(run_table(history, "all is read", history.end_s if t_s is None else t_s))
    assert isinstance(screen.file, StringIO)
    return screen.file.getvalue()


def test_a_robot_s_line_has_its_learning_and_an_event_its_cure(log: Path) -> None:
    lines = shown(log).splitlines()
    assert lines[0].startswith("demo trial 0: running; 0:00:06 so far")
    line = next(line for line in lines if line.startswith(" imitator"))
    for word in ("moving", "30", "33", "█▅▃", "3.70 V", "none"):
        assert word in line
    assert any(LOSS in line and "Look whether the tracking system sees its markers" in line for line in lines)


def test_an_earlier_moment_knows_nothing_of_what_comes(log: Path) -> None:
    text = shown(log, 2.5)
    assert LOSS not in text
    assert "█ " in text


def test_the_verb_prints_a_finished_log_once(log: Path) -> None:
    done = CliRunner().invoke(app, ["watch", str(log), "--move", "10"])
    assert done.exit_code == 0
    assert "the whole log is read" in done.output
    assert LOSS not in done.output
    with pytest.raises(UserError, match="--move 31: not every learner has made so many moves"):
        CliRunner().invoke(app, ["watch", str(log), "--move", "31"], catch_exceptions=False)


def test_time_is_told_as_people_do() -> None:
    assert [clock(seconds) for seconds in (0, 61.9, 36_000)] == ["0:00:00", "0:01:01", "10:00:00"]
