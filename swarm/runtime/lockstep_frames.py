"""The bytes of the lockstep: what a tick brings to a process, and what the process answers.

Thousands go to and fro in a second and none is stored, so they are plain structures around the messages' own
bytes: a process that has just been woken runs through as little code as can be. Little-endian throughout.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from swarm.messages.header import Header, Item

TICK = struct.Struct("<QqIH")
"""The start of a tick: its number, the time of its first step, the nanoseconds between steps, how many there
are (none ends the run). What it brings comes behind."""
BAD_FRAME = (struct.error, UnicodeDecodeError)
"""What reading a frame raises if it is none."""

_ANSWER = struct.Struct("<QH")
_ITEM = struct.Struct("<HIQQq")


class Answer(NamedTuple):
    """What a process published in a tick. Number 0 greets: its items' keys are what it listens to."""

    number: int
    process: str
    items: list[Item]


def pack_answer(number: int, process: str) -> bytes:
    """The start of an answer's frame; its items come behind."""
    name = process.encode()
    return _ANSWER.pack(number, len(name)) + name


def pack_item(key: str, header: Header, payload: bytes) -> bytes:
    """A message with its key and header."""
    name = key.encode()
    return _ITEM.pack(len(name), len(payload), *header) + name + payload


def unpack_answer(frame: bytes) -> Answer:
    """Raises one of `BAD_FRAME` if the bytes are no answer."""
    number, size = _ANSWER.unpack_from(frame)
    items_at = _ANSWER.size + size
    return Answer(number, frame[_ANSWER.size : items_at].decode(), unpack_items(frame, items_at))


def unpack_items(frame: bytes, at: int) -> list[Item]:
    """The messages from a place to the frame's end."""
    items = []
    while at < len(frame):
        name_size, payload_size, epoch, sequence, t_ns = _ITEM.unpack_from(frame, at)
        name_at = at + _ITEM.size
        payload_at = name_at + name_size
        at = payload_at + payload_size
        items.append(
            Item(frame[name_at:payload_at].decode(), Header(epoch, sequence, t_ns), frame[payload_at:at])
        )
    if at != len(frame):
        raise struct.error(f"{at} bytes are announced and {len(frame)} came")
    return items
