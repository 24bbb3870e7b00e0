"""`swarm check`: sound logs pass, and each fault is found and named."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from swarm.cli.main import main
from swarm.logs.check import check_log
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog


@pytest.fixture
def log(tmp_path: Path) -> SmallLog:
    small = SmallLog(tmp_path / "log.mcap", flush_every=10)
    small.add_curve("loner", range(100, 60, -1))
    return small


def test_a_sound_log_passes(log: SmallLog) -> None:
    found = check_log(log.close())
    assert (found.sound, found.indexed, found.messages) == (True, True, 40)
    assert found.remarks == []


def test_a_missing_index_is_a_fault(log: SmallLog, tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    data = log.close().read_bytes()
    torn.write_bytes(data[: len(data) // 2])
    found = check_log(torn)
    assert not found.indexed
    assert "cut short" in found.faults[0]
    torn.write_bytes(data[:-5])
    assert "does not end" in check_log(torn).faults[0]


def test_lost_learning_events_duplicates_and_bad_messages_are_faults(log: SmallLog) -> None:
    for sequence in (1, 2, 2, 5):
        log.add("robot/loner/move", pb.Move(number=sequence), sequence=sequence)
    log.add("robot/loner/pose", b"\xff")
    assert check_log(log.close()).faults == [
        "robot/loner/move: 2 messages missing",
        "robot/loner/move: 1 duplicates",
        "robot/loner/pose: 1 messages that cannot be decoded",
    ]


def test_lost_states_and_restarts_are_remarks(log: SmallLog) -> None:
    for sequence in (1, 2, 4):
        log.add("robot/loner/pose", pb.Pose(), sequence=sequence)
    log.add("robot/loner/pose", pb.Pose(), epoch=2)
    found = check_log(log.close())
    assert found.sound
    assert found.remarks == ["robot/loner/pose: 1 messages missing", "loner: restarted during the trial"]


def test_the_exit_code_says_it(
    log: SmallLog, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = log.close().read_bytes()
    (tmp_path / "torn.mcap").write_bytes(data[:-100])
    (tmp_path / "other.mcap").write_bytes(b"something else")
    codes = {}
    for name in ("log", "torn", "other"):
        monkeypatch.setattr(sys, "argv", ["swarm", "check", str(tmp_path / f"{name}.mcap"), "--json"])
        with pytest.raises(SystemExit) as left:
            main()
        codes[name] = left.value.code
    assert codes == {"log": 0, "torn": 1, "other": 2}
    sound, torn = map(json.loads, capsys.readouterr().out.splitlines())
    assert sound["sound"]
    assert torn["messages"] == 40
