"""The log: the wire's bytes, schemas embedded, nothing lost to a kill after a flush, nothing overwritten."""

from __future__ import annotations

from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from server.hubs.hub import Batch
from server.recording.recorder import MOST_CHANNELS, MOST_EPOCHS, Recorder, digest
from swarm.errors import UserError
from swarm.logs.reader import LogReader
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
    assert recorder.unknown_keys == {"robot/a/secret": 2}
    assert read(recorder.path).messages == recorder.messages == 1


def test_made_up_senders_end_no_recorder(tmp_path: Path) -> None:
    """65,536 epochs of one key and as many robots: MCAP has no more channels, and others are still heard."""
    recorder = Recorder(tmp_path / "log.mcap", ABOUT)
    for epoch in range(1, 65_537):
        items = [pose_item(1, epoch=epoch), Item(f"robot/r{epoch}/move", Header(1, 1, 0), b"x")]
        recorder.write(Batch(1000 * epoch, items))
    recorder.write_view("view/x", pb.Event(level=pb.Event.INFO), 65_537_000)
    recorder.close()
    assert sum(recorder.restarted_too_often.values()) == 2 * 65_536 - MOST_CHANNELS
    assert recorder.restarted_too_often["robot/a/pose"] == 65_536 - MOST_EPOCHS
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
