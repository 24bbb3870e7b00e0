"""What is larger than any record may be costs no other message, and no memory."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType, Writer

from swarm.logs.mcap_records import MAX_RECORD_BYTES
from swarm.logs.reader import LogReader
from swarm.logs.recover import recover_log
from tests.support.damage import told

LARGE = bytes(MAX_RECORD_BYTES + 1)
KINDS: dict[str, dict[str, Any]] = {
    "attachment": {},
    "zstd": {"compression": CompressionType.ZSTD},
    "lz4": {"compression": CompressionType.LZ4},
    "not compressed": {"compression": CompressionType.NONE},
    "not chunked": {"use_chunking": False},
}


def write_log(path: Path, kind: str) -> None:
    """Ten messages, something large, and ten more."""
    with path.open("wb") as file:
        writer = Writer(file, enable_data_crcs=True, **KINDS[kind])
        writer.start()
        schema = writer.register_schema("swarm.Move", "protobuf", b"")
        channel = writer.register_channel("robot/loner/move", "protobuf", schema)

        def add(number: int, data: bytes = b"\x08\x01") -> None:
            writer.add_message(channel, log_time=number, publish_time=number, sequence=number, data=data)

        for number in range(1, 11):
            add(number)
        if kind == "attachment":
            writer.add_attachment(0, 0, "video", "application/octet-stream", LARGE)
        else:
            add(99, LARGE)
        for number in range(11, 21):
            add(number)
        writer.finish()  # type: ignore[no-untyped-call]


@pytest.mark.parametrize("kind", KINDS)
def test_the_other_messages_are_read_and_recovered(tmp_path: Path, kind: str) -> None:
    path, whole = tmp_path / "large.mcap", tmp_path / "whole.mcap"
    write_log(path, kind)
    tracemalloc.start()
    reader = LogReader(path)
    numbers = [int(number) for part in reader.parts() for number in part.sequence]
    recovery = recover_log(path, whole)
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert numbers == sorted(number for _, number, _, _ in told(whole)) == list(range(1, 21))
    assert peak_bytes < MAX_RECORD_BYTES / 4
    assert [damage.reason for damage in reader.damage] == (
        [] if kind == "attachment" else [damage.reason for damage in recovery.lost]
    )
    assert len(recovery.lost) == 1
    assert "too large" in recovery.lost[0].reason or "left out" in recovery.lost[0].reason
