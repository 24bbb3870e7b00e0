"""`swarm recover`: all that can be read of a damaged log, in a new one that is sound."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
import zstandard

from swarm.cli.main import main
from swarm.logs.check import check_log
from swarm.logs.reader import LogError, LogReader
from swarm.logs.recover import recover_log
from tests.support.small_logs import SmallLog


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Forty messages in four chunks."""
    small = SmallLog(tmp_path / "log.mcap", flush_every=10)
    small.add_curve("loner", range(100, 60, -1))
    return small.close()


def numbers(path: Path) -> list[int]:
    return [int(number) for part in LogReader(path).parts() for number in part.sequence]


def test_a_sound_log_is_copied_whole(log: Path, tmp_path: Path) -> None:
    recovery = recover_log(log, tmp_path / "new.mcap")
    assert (recovery.messages, recovery.lost) == (40, [])
    assert check_log(tmp_path / "new.mcap").sound
    assert numbers(tmp_path / "new.mcap") == numbers(log) == list(range(1, 41))
    copied, original = (LogReader(path).read_metadata() for path in (tmp_path / "new.mcap", log))
    assert copied.pop("chain") != original.pop("chain"), "it has other chunks"
    assert copied == original


def test_a_cut_log_is_recovered_up_to_the_cut(log: Path, tmp_path: Path) -> None:
    data, torn = log.read_bytes(), tmp_path / "torn.mcap"
    for size in range(len(data) // 2, len(data), 50):
        torn.write_bytes(data[:size])
        whole = tmp_path / f"{size}.mcap"
        recovery = recover_log(torn, whole)
        reader = LogReader(torn)
        read = sum(len(part.sequence) for part in reader.parts())
        assert recovery.messages == read > 0
        found = check_log(whole)
        assert (found.indexed, found.damage) == (True, [])
        assert "recovered from a damaged log: 1 places" in found.lacking[0], "it is whole, and not complete"


def test_a_damaged_chunk_costs_its_own_messages(log: Path, tmp_path: Path) -> None:
    data = bytearray(log.read_bytes())
    data[data.index(zstandard.FRAME_HEADER) + 20] ^= 0xFF
    (tmp_path / "broken.mcap").write_bytes(data)
    recovery = recover_log(tmp_path / "broken.mcap", tmp_path / "new.mcap")
    assert recovery.messages == 30
    assert "checksum" in str(recovery.lost[0]) or "unpack" in str(recovery.lost[0])
    assert numbers(tmp_path / "new.mcap") == list(range(11, 41))


@pytest.mark.parametrize("index", ["sound", "damaged"])
def test_a_damaged_definition_is_taken_from_a_sound_index_alone(
    log: Path, tmp_path: Path, index: str
) -> None:
    """They stand in the first chunk: without it and the index nobody knows whose messages the rest are."""
    data = bytearray(log.read_bytes())
    data[data.index(zstandard.FRAME_HEADER) + 20] ^= 0xFF
    if index == "damaged":
        data[data.rindex(b"robot/loner/best_path")] ^= 0x01
    broken, whole = tmp_path / "broken.mcap", tmp_path / "whole.mcap"
    broken.write_bytes(data)
    if index == "damaged":
        with pytest.raises(LogError, match="no message can be read"):
            recover_log(broken, whole)
    else:
        assert recover_log(broken, whole).messages == 30
        assert {part.channel.key for part in LogReader(whole).parts()} == {"robot/loner/best_path"}


def test_the_command_says_what_it_did_and_overwrites_nothing(
    log: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    torn = log.with_name("torn.mcap")
    torn.write_bytes(log.read_bytes()[:-40])
    (log.with_name("other.mcap")).write_bytes(b"something else")
    codes, said = [], []
    nowhere = ("--out", str(log.with_name("nowhere") / "new.mcap"))
    for name, *options in (("torn",), ("torn",), ("other",), ("torn", *nowhere)):
        words = ["swarm", "recover", str(log.with_name(f"{name}.mcap")), "--json", *options]
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as left:
            main()
        codes.append(left.value.code)
        said.append(capsys.readouterr())
    assert codes == [0, 2, 2, 2]
    assert json.loads(said[0].out)["messages"] == 40
    assert "torn.recovered.mcap: exists already; nothing is overwritten" in said[1].err
    assert "is not an MCAP log" in said[2].err
    assert "cannot be written (No such file or directory)" in said[3].err
    assert not log.with_name("other.recovered.mcap").exists()
