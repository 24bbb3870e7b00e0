"""OptiTrack's NatNet, versions 2.5 to 4.1: message numbers, header, connecting.

Little-endian throughout. The layouts are those of the NatNet SDK's direct depacketization samples, checked
against captured traffic of versions 2.7, 2.9 and 3.0.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from struct import Struct

from tracker_bridge.protocols.cursor import Cursor, DatagramError, fixed_text

Version = tuple[int, int]
"""Major and minor."""

OLDEST: Version = (2, 5)
NEWEST: Version = (4, 1)

COMMAND_PORT = 1510
DATA_PORT = 1511
MULTICAST_GROUP = "239.255.42.99"

_HEADER = Struct("<HH")
_SENDER = Struct("<256s4B4B")
_CLOCK = Struct("<QHB4B")


class MessageId(IntEnum):
    """The first number of every packet."""

    CONNECT = 0
    SERVER_INFO = 1
    REQUEST = 2
    RESPONSE = 3
    REQUEST_MODEL_DEFINITIONS = 4
    MODEL_DEFINITIONS = 5
    REQUEST_FRAME = 6
    FRAME = 7
    MESSAGE = 8
    DISCONNECT = 9
    KEEP_ALIVE = 10
    ECHO_REQUEST = 12
    ECHO_RESPONSE = 13
    DISCOVERY = 14
    UNRECOGNIZED = 100


@dataclass(frozen=True)
class ServerInfo:
    """What a server says of itself; what only 3.0 and later say is 0 or empty before."""

    application: str
    application_version: tuple[int, ...]
    version: Version
    clock_hz: int = 0
    data_port: int = 0
    is_multicast: bool = False
    group: str = ""


def split(data: bytes) -> tuple[int, bytes]:
    """The message's number and its payload; DatagramError unless the length is as the header says."""
    cursor = Cursor(data)
    number, length = cursor.take(_HEADER)
    if length != cursor.left:
        raise DatagramError("another length than its header says")
    return number, cursor.block(length)


def packed(message: MessageId, payload: bytes = b"") -> bytes:
    """A whole packet."""
    return _HEADER.pack(message, len(payload)) + payload


def connect(name: str, version: Version = NEWEST) -> bytes:
    """The packet with which a client asks a server for its ServerInfo."""
    return packed(MessageId.CONNECT, _SENDER.pack(name.encode(), 0, 0, 0, 0, *version, 0, 0))


def parse_server_info(payload: bytes) -> ServerInfo:
    """264 bytes up to version 2.9, 279 from 3.0."""
    cursor = Cursor(payload)
    name, *versions = cursor.take(_SENDER)
    application, version = tuple(versions[:4]), (versions[4], versions[5])
    if version < (3, 0) or cursor.left < _CLOCK.size:
        return ServerInfo(fixed_text(name), application, version)
    clock_hz, port, multicast, *group = cursor.take(_CLOCK)
    dotted = ".".join(map(str, group))
    return ServerInfo(fixed_text(name), application, version, clock_hz, port, bool(multicast), dotted)


def pack_server_info(info: ServerInfo) -> bytes:
    """The payload of a server's answer, for emulators."""
    payload = _SENDER.pack(info.application.encode(), *info.application_version, *info.version, 0, 0)
    if info.version < (3, 0):
        return payload
    group = [int(part) for part in (info.group or "0.0.0.0").split(".")]
    return payload + _CLOCK.pack(info.clock_hz, info.data_port, info.is_multicast, *group)


def version_of(text: str) -> Version:
    """ "2.7" as numbers; ValueError with the cure unless this project knows that version."""
    parts = text.split(".")
    if len(parts) < 2 or not all(part.isdigit() for part in parts):
        raise ValueError(f"{text!r} is no NatNet version such as 3.0")
    version = (int(parts[0]), int(parts[1]))
    if not is_known(version):
        raise ValueError(f"NatNet {text} is not known; versions 2.5 to 4.1 are")
    return version


def is_known(version: Version) -> bool:
    return OLDEST <= version <= NEWEST
