"""The real NatNet traffic in tests/data/natnet: its packets, and what the vendor's client printed."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

NATNET = Path(__file__).parent.parent / "data" / "natnet"

Numbers = tuple[float, ...]


def packets(message: int) -> list[bytes]:
    """The UDP payloads of the capture whose NatNet message number this is."""
    return [data for data in _udp_payloads() if struct.unpack_from("<H", data)[0] == message]


def single(name: str) -> bytes:
    """One of the packets that were kept apart."""
    return (NATNET / f"{name}.bin").read_bytes()


def _udp_payloads() -> Iterator[bytes]:
    """pcapng: blocks of type 6 hold Ethernet frames from their byte 28 on; those with IPv4 and UDP."""
    data = (NATNET / "traffic.pcapng").read_bytes()
    at = 0
    while at < len(data):
        kind, size = struct.unpack_from("<II", data, at)
        frame = data[at + 28 : at + 28 + struct.unpack_from("<I", data, at + 20)[0]]
        if kind == 6 and frame[12:14] == b"\x08\x00" and frame[23] == 17:
            udp = 14 + 4 * (frame[14] & 15)
            yield frame[udp + 8 : udp + struct.unpack_from(">H", frame, udp + 4)[0]]
        at += size


@dataclass
class Printed:
    """A frame as the vendor's client printed it, to two decimals."""

    number: int
    timestamp_s: float = 0.0
    system_latency_ms: float = 0.0
    others: list[Numbers] = field(default_factory=list)
    bodies: list[tuple[int, bool, float, Numbers]] = field(default_factory=list)
    """Id, whether valid, error, and x, y, z, qx, qy, qz, qw."""
    markers: list[tuple[int, int, bool, bool, bool, float, Numbers]] = field(default_factory=list)
    """Body, id, whether occluded, solved from the point cloud, solved from the model, size, place."""


def printed() -> list[Printed]:
    """Every frame of the vendor's output; other lines, which other threads printed in between, are left."""
    frames: list[Printed] = []
    body: tuple[int, bool, float] | None = None
    for line in (NATNET / "SampleClient_output.txt").read_text().splitlines():
        if found := re.match(r"FrameID : (\d+)", line):
            frames.append(Printed(int(found[1])))
        elif not frames:
            continue
        elif found := re.match(r"Timestamp : ([\d.]+)", line):
            frames[-1].timestamp_s = float(found[1])
        elif found := re.match(r"System latency : ([\d.]+)", line):
            frames[-1].system_latency_ms = float(found[1])
        elif found := re.match(r"Other Marker \d+ : (.*)", line):
            frames[-1].others.append(tuple(map(float, found[1].split())))
        elif found := re.match(r"Rigid Body \[ID=(\d+) +Error=([\d.]+) +Valid=(\d)\]", line):
            body = (int(found[1]), found[3] == "1", float(found[2]))
        elif body and re.match(r"\t[-\d]", line):
            frames[-1].bodies.append((*body, tuple(map(float, line.split()))))
            body = None
        elif found := _MARKER.match(line):
            flags = (found[3] == "1", found[4] == "1", found[5] == "1")
            place = tuple(map(float, found[7].split(",")))
            frames[-1].markers.append((int(found[1]), int(found[2]), *flags, float(found[6]), place))
    return frames


_MARKER = re.compile(
    r"Labeled Marker \[ModelID=(\d+), MarkerID=(\d+), Occluded=(\d), PCSolved=(\d), ModelSolved=(\d)\]"
    r" \[size=([\d.]+)\] \[pos=([-\d.,]+)\]"
)
