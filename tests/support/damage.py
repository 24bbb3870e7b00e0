"""Damage to a log, of every kind and in every region, and what must survive it by an independent count."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from mcap.reader import make_reader
from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader, breakup_chunk

Told = tuple[str, int, int, bytes]
"""Topic, sequence number, time of receipt and payload of one message."""
KINDS = ("flip", "zero", "cut")
CHUNK_HEAD_BYTES = 60
LAST_BYTES = 37
"""The footer and what closes the file."""
DATA_END_BYTES = 13
LONGEST_ZEROS_BYTES = 600


@dataclass(frozen=True)
class Stretch:
    """A chunk's place in the file, and its messages."""

    begin: int
    end: int
    messages: Counter[Told]


@dataclass(frozen=True)
class Wound:
    """A log whose bytes from `begin` to `end` are not what they were; after a cut none follow."""

    kind: str
    region: str
    begin: int
    end: int
    data: bytes


def told(path: Path) -> Counter[Told]:
    """Every message of a log, as the `mcap` package's own reader finds it with every checksum verified."""
    with path.open("rb") as file:
        messages = make_reader(file, validate_crcs=True).iter_messages(log_time_order=False)
        return Counter((channel.topic, one.sequence, one.log_time, one.data) for _, channel, one in messages)


def defined(path: Path) -> set[tuple[str, str, bytes]]:
    """Topic, schema's name and schema of every channel, as the `mcap` package finds them."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    schemas = [summary.schemas[channel.schema_id] for channel in summary.channels.values()]
    topics = [channel.topic for channel in summary.channels.values()]
    return {(topic, schema.name, schema.data) for topic, schema in zip(topics, schemas, strict=True)}


def stretches(path: Path) -> list[Stretch]:
    """The chunks of an undamaged log, as the `mcap` package finds them."""
    data = path.read_bytes()
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    found = []
    for index in summary.chunk_indexes:
        begin, end = index.chunk_start_offset, index.chunk_start_offset + index.chunk_length
        chunk = next(StreamReader(BytesIO(data[begin:end]), skip_magic=True, emit_chunks=True).records)
        assert isinstance(chunk, Chunk)
        messages = [one for one in breakup_chunk(chunk, validate_crc=True) if isinstance(one, Message)]
        topics = {number: channel.topic for number, channel in summary.channels.items()}
        told = ((topics[one.channel_id], one.sequence, one.log_time, one.data) for one in messages)
        found.append(Stretch(begin, end, Counter(told)))
    return found


def surviving(chunks: list[Stretch], wound: Wound) -> Counter[Told]:
    """The messages of the chunks that a wound has not touched."""
    end = len(wound.data) if wound.kind == "cut" else None
    whole: Counter[Told] = Counter()
    for chunk in chunks:
        touched = chunk.end > end if end is not None else chunk.begin < wound.end and wound.begin < chunk.end
        if not touched:
            whole += chunk.messages
    return whole


def regions(path: Path, chunks: list[Stretch]) -> dict[str, list[tuple[int, int]]]:
    """The places of everything of which a log consists."""
    size = path.stat().st_size
    with path.open("rb") as file:
        file.seek(size - LAST_BYTES + 9)
        summary = int.from_bytes(file.read(8), "little")
    heads = [(chunk.begin, chunk.begin + CHUNK_HEAD_BYTES) for chunk in chunks]
    follow = [chunk.begin for chunk in chunks[1:]] + [summary - DATA_END_BYTES]
    return {
        "head": [(0, chunks[0].begin)],
        "chunk head": heads,
        "chunk data": [(head[1], chunk.end) for head, chunk in zip(heads, chunks, strict=True)],
        "between chunks": [(chunk.end, begin) for chunk, begin in zip(chunks, follow, strict=True)],
        "data end": [(summary - DATA_END_BYTES, summary)],
        "index": [(summary, size - LAST_BYTES)],
        "footer": [(size - LAST_BYTES, size)],
    }


def wounds(path: Path, chunks: list[Stretch], each: int, seed: int) -> Iterator[Wound]:
    """So many wounds of each kind in each region."""
    generator, data = random.Random(seed), path.read_bytes()
    for region, places in regions(path, chunks).items():
        for kind in KINDS:
            for _ in range(each):
                begin, end = generator.choice(places)
                place = generator.randrange(begin, end)
                yield _wound(generator, data, kind, region, place)


def _wound(generator: random.Random, data: bytes, kind: str, region: str, place: int) -> Wound:
    if kind == "cut":
        return Wound(kind, region, place, len(data), data[:place])
    if kind == "flip":
        flipped = data[place] ^ 1 << generator.randrange(8)
        return Wound(kind, region, place, place + 1, data[:place] + bytes([flipped]) + data[place + 1 :])
    end = min(len(data), place + generator.randrange(1, LONGEST_ZEROS_BYTES))
    return Wound(kind, region, place, end, data[:place] + bytes(end - place) + data[end:])
