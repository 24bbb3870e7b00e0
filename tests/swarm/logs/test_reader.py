"""The log reader: what was recorded comes back, and nothing hostile or broken gets the better of it."""

from __future__ import annotations

import os
import struct
import tracemalloc
from contextlib import nullcontext
from pathlib import Path

import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from swarm.logs.identity import identify
from swarm.logs.mcap_records import MAGIC, MAX_RECORD_BYTES, frame_at
from swarm.logs.reader import LogError, LogReader, Part, nothing
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog, metadata

MOVES = "robot/loner/move"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Sixty messages of three keys, one of them after a restart, in chunks of ten."""
    small = SmallLog(tmp_path / "trial-000.mcap", flush_every=10)
    for number in range(1, 31):
        small.add(MOVES, pb.Move(number=number, state=number % 100))
        small.add("robot/loner/pose", pb.Pose(x_m=number / 100), epoch=1 if number <= 20 else 2)
    return small.close()


def payloads(parts: list[Part]) -> dict[tuple[str, int], list[bytes]]:
    found: dict[tuple[str, int], list[bytes]] = {}
    for part in parts:
        found.setdefault((part.channel.key, part.channel.epoch), []).extend(part.payloads)
    return found


def read(path: Path) -> tuple[LogReader, dict[tuple[str, int], list[bytes]]]:
    reader = LogReader(path)
    return reader, payloads(list(reader.parts()))


def test_what_was_recorded_comes_back(log: Path) -> None:
    reader, found = read(log)
    assert reader.damage == []
    assert reader.messages == reader.recorded_messages == 60
    assert {name: reader.metadata[name] for name in metadata()} == metadata()
    assert [pb.Move.FromString(payload).number for payload in found[MOVES, 1]] == list(range(1, 31))
    assert {place: len(of_key) for place, of_key in found.items()} == {
        (MOVES, 1): 30,
        ("robot/loner/pose", 1): 20,
        ("robot/loner/pose", 2): 10,
    }


def test_numbers_and_times_are_those_of_the_header(log: Path) -> None:
    parts = [part for part in LogReader(log).parts() if part.channel.epoch == 2]
    assert [list(part.sequence) for part in parts] == [list(range(1, 11))]
    assert list(parts[0].publish_t_ns[:2]) == [4_200_000_000, 4_400_000_000]
    assert list(parts[0].receive_t_ns[:2]) == [4_200_000_000, 4_400_000_000]


def test_payloads_that_nobody_wants_are_not_kept(log: Path) -> None:
    reader = LogReader(log, nothing)
    parts = list(reader.parts())
    assert reader.messages == sum(len(part.sequence) for part in parts) == 60
    assert not any(part.payloads for part in parts)


def end_of_first_chunk(path: Path) -> int:
    with path.open("rb") as file:
        frame = frame_at(file, len(MAGIC), path.stat().st_size)
        while frame.opcode != Opcode.CHUNK:
            frame = frame_at(file, frame.end_bytes, path.stat().st_size)
    return frame.end_bytes


def test_a_log_cut_anywhere_gives_the_whole_chunks_before_the_cut(log: Path, tmp_path: Path) -> None:
    data, cut = log.read_bytes(), tmp_path / "cut.mcap"
    _, whole = read(log)
    counts, first = [], end_of_first_chunk(log)
    for size in range(len(MAGIC), len(data), 7):
        cut.write_bytes(data[:size])
        reader = LogReader(cut)
        found = {}
        with nullcontext() if size >= first else pytest.raises(LogError, match="cut short"):
            found = payloads(list(reader.parts()))
        assert all(of_key == whole[place][: len(of_key)] for place, of_key in found.items())
        assert reader.damage
        assert 0 < reader.damage[-1].offset_bytes <= size
        counts.append(reader.messages)
    assert counts == sorted(counts)
    assert set(counts) == {0, 10, 20, 30, 40, 50, 60}


def test_a_flipped_bit_never_changes_a_message_unnoticed(log: Path, tmp_path: Path) -> None:
    data, flipped = log.read_bytes(), tmp_path / "flipped.mcap"
    _, whole = read(log)
    noticed = 0
    for place in range(0, len(data), 3):
        broken = bytearray(data)
        broken[place] ^= 1 << place % 8
        flipped.write_bytes(broken)
        try:
            reader, found = read(flipped)
        except LogError:
            continue
        noticed += bool(reader.damage)
        assert reader.damage or found == whole
    assert noticed > 100


def test_a_damaged_chunk_costs_no_other(log: Path, tmp_path: Path) -> None:
    """The checksum over everything shows as well that the file is not what was written."""
    data = bytearray(log.read_bytes())
    place = data.index(zstandard.FRAME_HEADER)
    data[place + 20] ^= 0xFF
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(data)
    reader, _ = read(broken)
    assert reader.messages == 50
    assert [damage.messages for damage in reader.damage] == [0, 50]


def test_a_log_whose_recorder_was_killed_is_read_to_its_last_flush(tmp_path: Path) -> None:
    small = SmallLog(tmp_path / "trial-000.mcap", flush_every=10)
    for number in range(1, 26):
        small.add(MOVES, pb.Move(number=number))
    copy = tmp_path / "killed.mcap"
    copy.write_bytes(small.path.read_bytes())
    small.close()
    reader, _ = read(copy)
    assert reader.messages == 20
    assert reader.recorded_messages is None
    assert "cut short" in reader.damage[0].reason


def record(opcode: int, body: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(body)) + body


def chunk(content: bytes, claims: int) -> bytes:
    """A chunk record whose unpacked size is a lie."""
    packed = zstandard.compress(content)
    name = b"zstd"
    head = struct.pack("<QQQI", 0, 0, claims, 0) + struct.pack("<I", len(name)) + name
    return record(6, head + struct.pack("<Q", len(packed)) + packed)


@pytest.mark.parametrize("claims", [100, MAX_RECORD_BYTES, 2**40])
def test_a_chunk_that_unpacks_to_more_than_it_says_fills_no_memory(tmp_path: Path, claims: int) -> None:
    bomb = tmp_path / "bomb.mcap"
    bomb.write_bytes(MAGIC + record(1, bytes(8)) + chunk(bytes(2 * MAX_RECORD_BYTES), claims))
    tracemalloc.start()
    with pytest.raises(LogError, match="chunk"):
        list(LogReader(bomb).parts())
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak_bytes < 3 * MAX_RECORD_BYTES


@pytest.mark.parametrize("length", [2**31, 2**62, 2**64 - 1])
def test_a_record_that_claims_to_be_huge_ends_the_reading(tmp_path: Path, length: int) -> None:
    path = tmp_path / "huge.mcap"
    path.write_bytes(MAGIC + struct.pack("<BQ", 6, length) + bytes(100))
    with pytest.raises(LogError, match="cut short"):
        list(LogReader(path).parts())


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "empty"),
        (MAGIC[:5], "does not begin"),
        (b"PK\x03\x04" * 50, "does not begin"),
        (MAGIC, "cut short"),
    ],
)
def test_what_is_no_log_is_refused_with_a_reason(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(content)
    with pytest.raises(LogError, match=reason):
        list(LogReader(path).parts())


def test_a_directory_a_pipe_and_a_missing_file_are_refused_at_once(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.mcap"
    os.mkfifo(pipe)
    for path, reason in ((tmp_path, "directory"), (pipe, "no regular"), (tmp_path / "none", "No such file")):
        with pytest.raises(LogError, match=reason):
            identify(path)


def foreign_log(path: Path, chunked: bool = True) -> None:
    """A log of somebody else's, with one key of ours: other encodings, other keys, no metadata."""
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=chunked, compression=CompressionType.LZ4, enable_data_crcs=True)
        writer.start()
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        foreign = writer.register_channel("/chatter", "cdr", schema)
        known = writer.register_channel(
            MOVES, "protobuf", writer.register_schema("swarm.Move", "protobuf", b"")
        )
        other = writer.register_channel("robot/loner/pose", "cdr", 0)
        for channel in (foreign, known, other):
            writer.add_message(channel, log_time=1, publish_time=1, sequence=1, data=b"payload")
        writer.finish()  # type: ignore[no-untyped-call]


@pytest.mark.parametrize("chunked", [True, False])
def test_foreign_channels_are_counted_and_not_decoded(tmp_path: Path, chunked: bool) -> None:
    path = tmp_path / "foreign.mcap"
    foreign_log(path, chunked)
    reader = LogReader(path)
    topics = {part.channel.key: part.channel.topic for part in reader.parts()}
    assert reader.messages == 3
    assert reader.damage == []
    assert [key for key, topic in topics.items() if topic is not None] == [MOVES]
    with pytest.raises(LogError, match="which run and trial"):
        identify(path)


def test_the_checksum_over_all_records_is_verified_where_there_is_one(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    foreign_log(path, chunked=False)
    data = path.read_bytes()
    path.write_bytes(data.replace(b"payload", b"paylaod", 1))
    reader = LogReader(path)
    list(reader.parts())
    assert "checksum" in reader.damage[0].reason


def test_two_channels_of_one_number_are_damage(tmp_path: Path) -> None:
    def channel(key: bytes) -> bytes:
        texts = b"".join(struct.pack("<I", len(text)) + text for text in (key, b"protobuf"))
        return record(4, struct.pack("<HH", 1, 0) + texts + struct.pack("<I", 0))

    message = record(5, struct.pack("<HIQQ", 1, 1, 1, 1))
    path = tmp_path / "twice.mcap"
    path.write_bytes(MAGIC + record(1, bytes(8)) + channel(b"a") + message + channel(b"b") + message)
    reader = LogReader(path)
    list(reader.parts())
    assert "defined twice" in reader.damage[0].reason
