"""The log: the wire's bytes, schemas embedded, nothing lost to a kill after a flush, nothing overwritten."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from server.hubs.hub import Batch
from server.recording.disk_sync import DiskSync
from server.recording.recorder import (
    LAID_DOWN_EVERY_S,
    MAX_MESSAGE_BYTES,
    MOST_CHANNELS,
    MOST_EPOCHS,
    Recorder,
    digest,
)
from swarm.errors import UserError
from swarm.logs.ending import ending_of
from swarm.logs.reader import LogError, LogReader
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item

ABOUT = {"run": {"seed": "1"}, "robots": {"a": "learner learner"}}


def pose_item(sequence: int, epoch: int = 1, x_m: float = 0.5) -> Item:
    payload = pb.Pose(x_m=x_m).SerializeToString()
    return Item("robot/a/pose", Header(epoch, sequence, sequence * 100), payload)


def read(path: Path) -> LogReader:
    reader = LogReader(path)
    for _ in reader.parts():
        pass
    return reader


def test_payload_numbers_and_times_are_those_of_the_wire(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    move_item = Item("robot/a/move", Header(1, 1, 800), b"no protobuf at all")
    recorder.write(Batch(1000, [pose_item(7), move_item]))
    recorder.close()
    with (tmp_path / "log.mcap").open("rb") as file:
        reader = make_reader(file)
        found = list(reader.iter_messages())
        about = {record.name: record.metadata for record in reader.iter_metadata()}
    assert about.pop("chain")["chunks"] == "1"
    assert about == ABOUT
    (_, channel, pose), (_, _, move) = sorted(found, key=lambda each: each[1].topic, reverse=True)
    assert channel.metadata == {"epoch": "1", "robot": "a", "delivery": "newest"}
    assert (pose.sequence, pose.log_time, pose.publish_time, pose.data) == (
        7,
        1000,
        700,
        pose_item(7).payload,
    )
    assert move.data == b"no protobuf at all", "the recorder does not judge"


def test_the_schemas_in_the_file_decode_it(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    recorder.write(Batch(1000, [pose_item(1, x_m=0.25)]))
    recorder.close()
    with (tmp_path / "log.mcap").open("rb") as file:
        ((_, _, _, decoded),) = make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages()
    assert decoded.x_m == 0.25


def test_a_restart_of_the_sender_is_a_channel_of_its_own(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    recorder.write(Batch(1000, [pose_item(1, epoch=5), pose_item(2, epoch=5), pose_item(1, epoch=6)]))
    recorder.close()
    with (tmp_path / "log.mcap").open("rb") as file:
        seen = [
            (channel.metadata["epoch"], message.sequence)
            for _, channel, message in make_reader(file).iter_messages()
        ]
    assert seen == [("5", 1), ("5", 2), ("6", 1)]


def test_what_the_key_table_does_not_know_is_counted(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    secrets = [Item("robot/a/secret", Header(1, n, 0), b"") for n in (1, 2)]
    recorder.write(Batch(1000, [*secrets, pose_item(1)]))
    recorder.close()
    assert recorder.left_out.unknown_keys == {"robot/a/secret": 2}
    assert read(recorder.path).messages == recorder.messages == 1


def test_made_up_senders_end_no_recorder(tmp_path: Path) -> None:
    """65,536 epochs of one key and as many robots: MCAP has no more channels, and others are still heard."""
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    for epoch in range(1, 65_537):
        items = [pose_item(1, epoch=epoch), Item(f"robot/r{epoch}/move", Header(1, 1, 0), b"x")]
        recorder.write(Batch(1000 * epoch, items))
    recorder.write_view("view/x", pb.Event(level=pb.Event.INFO), 65_537_000)
    recorder.close()
    assert sum(recorder.left_out.restarted_too_often.values()) == 2 * 65_536 - MOST_CHANNELS
    assert recorder.left_out.restarted_too_often["robot/a/pose"] == 65_536 - MOST_EPOCHS
    assert read(recorder.path).damage == []


def test_what_was_flushed_can_be_read_without_a_close(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    for number in range(1, 101):
        recorder.write(Batch(number * 1000, [pose_item(number)]))
    recorder.flush()
    copy = tmp_path / "as-after-a-kill.mcap"
    copy.write_bytes(recorder.path.read_bytes())
    recorder.close()
    recorder.close()
    killed, closed = read(copy), read(recorder.path)
    assert (killed.messages, killed.recorded_messages) == (100, None)
    assert (closed.messages, closed.recorded_messages, closed.damage) == (100, 100, [])


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "log.mcap").write_bytes(b"precious")
    with pytest.raises(UserError, match=r"log\.mcap: exists already"):
        Recorder(tmp_path / "log.mcap", ABOUT)
    assert (tmp_path / "log.mcap").read_bytes() == b"precious"


def test_a_digest_depends_on_every_byte_and_the_order(tmp_path: Path) -> None:
    one, other = tmp_path / "1", tmp_path / "2"
    one.write_bytes(b"a" * 3_000_000)
    other.write_bytes(b"a" * 2_999_999 + b"b")
    assert len({digest([one]), digest([other]), digest([one, other]), digest([other, one])}) == 4
    assert digest([]) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"


class Clock:
    """A monotonic clock that a test sets."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def as_after_a_kill(recorder: Recorder, copy: Path) -> int:
    """How many messages can be read of what the operating system has of a log."""
    copy.write_bytes(recorder.path.read_bytes())
    try:
        return read(copy).messages
    except LogError:
        return 0


def test_a_kill_loses_what_came_since_a_moment_ago(tmp_path: Path) -> None:
    clock = Clock()
    recorder = Recorder(tmp_path / "log.mcap", ABOUT, clock)
    copy, kept = tmp_path / "copy.mcap", []
    for number in range(1, 31):
        clock.now_s = number * LAID_DOWN_EVERY_S / 10
        recorder.write(Batch(number * 1000, [pose_item(number)]))
        kept.append(as_after_a_kill(recorder, copy))
    recorder.close()
    assert kept[0] == 1, "the first at once"
    assert all(number - held <= 10 for number, held in enumerate(kept, start=1))
    assert kept == sorted(kept)
    assert read(recorder.path).messages == 30


def test_a_log_is_the_same_whatever_the_clock_says(tmp_path: Path) -> None:
    """Also where what was laid down was longer than what is left in the end."""
    logs = []
    for name, period_s in (("still", 0.0), ("fast", 1.0)):
        clock = Clock()
        recorder = Recorder(tmp_path / name, ABOUT, clock)
        for number in range(1, 3001):
            clock.now_s += period_s
            payload = bytes([number % 251]) * (number % 50)
            item = Item(f"robot/{'ab'[number % 2]}/event", Header(1, number, number), payload)
            recorder.write(Batch(number * 1000, [item]))
            if number % 1000 == 0:
                recorder.flush()
        recorder.end("complete", "", None)
        recorder.close()
        assert read(recorder.path).damage == []
        logs.append(recorder.path.read_bytes())
    assert logs[0] == logs[1]


def test_what_is_too_large_is_refused_counted_and_costs_nothing_else(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    item = Item("robot/a/event", Header(1, 2, 0), bytes(MAX_MESSAGE_BYTES + 1))
    recorder.write(Batch(1000, [pose_item(1), item, pose_item(2)]))
    recorder.end("complete", "", None)
    recorder.close()
    assert ending_of(read(recorder.path).metadata).sent["robot/a/event", 1] == 2, "it is missing"
    assert recorder.left_out.oversized == {"robot/a/event": 1}
    assert read(recorder.path).messages == recorder.messages == 2


def test_everything_in_the_log_is_counted(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    recorder.write(Batch(1000, [pose_item(1)]))
    recorder.write_view("view/log", pb.Event(name="e"), 1000)
    recorder.close()
    assert read(recorder.path).messages == recorder.messages == 2


def test_what_was_sent_stands_at_the_end(tmp_path: Path) -> None:
    """By the senders' own account, or, where all of it was heard, by the last number."""
    for name, accounts, last in (("heard", None, 3), ("told", {("robot/a/pose", 1): 5}, 5)):
        recorder = Recorder(tmp_path / name, ABOUT)
        recorder.write(Batch(1000, [pose_item(1), pose_item(3)]))
        recorder.end("interrupted", "by a test", accounts)
        recorder.close()
        ending = ending_of(read(recorder.path).metadata)
        assert (ending.state, ending.reason) == ("interrupted", "by a test")
        assert ending.sent == {("robot/a/pose", 1): last}


def test_a_log_is_brought_to_the_disk_now_and_then(tmp_path: Path) -> None:
    with (tmp_path / "file").open("wb") as file:
        sync = DiskSync(file.fileno(), period_s=0.001)
        sync.synced.wait()
        sync.close()
    assert sync.failure is None


def test_a_disk_that_takes_nothing_is_known() -> None:
    reading, writing = os.pipe()
    sync = DiskSync(writing, period_s=1000.0)
    sync.close()
    os.close(reading)
    os.close(writing)
    assert isinstance(sync.failure, OSError), "a pipe cannot be synced"
