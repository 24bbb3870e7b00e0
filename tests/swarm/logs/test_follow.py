"""A log that is read while it is written: every message once, in order, and nothing that is half there."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.recording.recorder import Recorder
from swarm.logs.follow import LogFollower, Timed
from swarm.logs.mcap_index import read_index
from swarm.logs.reader import LogError, LogReader
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from tests.support.learnt_logs import learnt_log
from tests.support.small_logs import SmallLog, metadata


def read(follower: LogFollower) -> list[Timed]:
    return [timed for chunk in follower.read() for timed in chunk]


def pose(number: int) -> pb.Pose:
    return pb.Pose(x_m=number / 1000, captured_t_ns=number)


def test_a_closed_log_gives_what_the_reader_gives(tmp_path: Path) -> None:
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 200)
    expected = sorted(
        (int(t_ns), part.channel.key, int(number), payload)
        for part in LogReader(log).parts()
        for t_ns, number, payload in zip(part.receive_t_ns, part.sequence, part.payloads, strict=True)
    )
    follower = LogFollower(log)
    found = read(follower)
    assert sorted((t_ns, item.key, item.header.sequence, item.payload) for t_ns, item in found) == expected
    assert [t_ns for t_ns, _ in found] == sorted(t_ns for t_ns, _ in found)
    assert follower.ended
    assert follower.metadata["run"]["name"] == "small"
    assert read(follower) == []
    follower.close()


def test_a_log_that_grows_gives_each_message_once(tmp_path: Path) -> None:
    """The recorder lays its open chunk down again and again, and now and then ends it."""
    clock_s = iter(range(10_000))
    log = SmallLog(tmp_path / "trial-000.mcap", flush_every=70)
    log.recorder.close()
    (tmp_path / "trial-000.mcap").unlink()
    log.recorder = Recorder(tmp_path / "trial-000.mcap", metadata(), lambda: next(clock_s))
    follower = LogFollower(log.path)
    heard: list[int] = []
    for number in range(1, 300):
        log.add("robot/imitator/pose", pose(number))
        if number % 7 == 0:
            heard += [item.header.sequence for _, item in read(follower)]
            assert heard == list(range(1, number + 1)), "as soon as it is laid down"
            assert not follower.ended
    log.close()
    heard += [item.header.sequence for _, item in read(follower)]
    assert heard == list(range(1, 300))
    assert read(follower) == []
    assert follower.ended
    follower.close()


def test_only_wanted_channels_are_given(tmp_path: Path) -> None:
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 40)
    follower = LogFollower(log, lambda channel: channel.topic is topics.BEST_PATH)
    assert {item.key for _, item in read(follower)} == {"robot/imitator/best_path"}
    follower.close()


def test_a_damaged_log_is_refused_with_the_cure(tmp_path: Path) -> None:
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 400)
    with log.open("rb") as file:
        chunk = read_index(file).chunks[0]
    content = bytearray(log.read_bytes())
    content[chunk + 200] ^= 0xFF
    log.write_bytes(content)
    follower = LogFollower(log)
    with pytest.raises(LogError, match="swarm recover"):
        read(follower)
    follower.close()


def test_another_file_is_no_log(tmp_path: Path) -> None:
    file = tmp_path / "notes.mcap"
    file.write_text("these are notes, and no log")
    with pytest.raises(LogError, match="does not begin like one"):
        LogFollower(file)
