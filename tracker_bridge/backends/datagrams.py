"""Datagrams as they arrive: from whom, how long ago, and which were refused."""

from __future__ import annotations

import socket
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from struct import Struct
from typing import NamedTuple, Protocol, runtime_checkable

from swarm.clock import NS_PER_S
from swarm.errors import UserError
from tracker_bridge.protocols.cursor import DatagramError

LARGEST_BYTES = 65_536
"""More than UDP can carry."""
RECEIVE_BUFFER_BYTES = 4 * 2**20
"""Some 100 ms of the largest swarm, for a machine that was busy; the system may give less."""
MOST_AT_ONCE = 2_000
"""A flood may not keep the bridge from its robots: what is left waits for the next tick."""
OLDEST_NS = 10 * NS_PER_S
"""A receive buffer of 4 MB does not hold more of any stream."""
ONE_MOMENT_NS = 100_000
"""Looking at three clocks takes 1 us."""
MOST_SENDERS = 100
"""Whoever invents senders may not fill the memory."""

_SO_TIMESTAMPNS = 35
"""Linux: the kernel says when a datagram arrived. The number is that of <asm-generic/socket.h>."""
_TIMESPEC = Struct("@qq")
_ROOM_FOR_NOTES = socket.CMSG_SPACE(_TIMESPEC.size)


class Datagram(NamedTuple):
    """What arrived, from whom, and the machine's monotonic time at which the kernel had it."""

    data: bytes
    sender: str
    received_ns: int


@dataclass
class Arrivals:
    """What a receiver has counted since it began."""

    senders: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    """Datagrams by the reason for which they were refused."""
    hints: set[str] = field(default_factory=set)
    """What the sender said that does not fit the experiment's [tracker] table."""

    def count(self, sender: str) -> None:
        known = sender in self.senders or len(self.senders) < MOST_SENDERS
        self.senders[sender if known else "others"] += 1

    def refuse(self, error: DatagramError) -> None:
        self.refused[str(error)] += 1


@runtime_checkable
class Receiving(Protocol):
    """A backend that can say what arrived."""

    arrivals: Arrivals


class DatagramSocket:
    """A UDP socket that never waits. With a group it joins it on the interface of that address."""

    def __init__(self, interface: str, port: int, group: str = "") -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._set_up(interface, port, group)
        except OSError as error:
            self._socket.close()
            raise UserError(f"[tracker] cannot listen on {interface}:{port}: {error}") from error

    def _set_up(self, interface: str, port: int, group: str) -> None:
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        self._socket.bind((group or interface, port))
        if group:
            membership = socket.inet_aton(group) + socket.inet_aton(interface)
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)

    @property
    def port(self) -> int:
        port: int = self._socket.getsockname()[1]
        return port

    def fileno(self) -> int:
        """For `select`, by which one can wait until something arrives."""
        return self._socket.fileno()

    def send(self, data: bytes, host: str, port: int) -> None:
        """Best effort: a server that is not there yet is asked again later."""
        try:
            self._socket.sendto(data, (host, port))
        except OSError:
            return

    def arrived(self) -> Iterator[Datagram]:
        """Everything that waits, oldest first."""
        for _ in range(MOST_AT_ONCE):
            try:
                data, notes, _, (host, port) = self._socket.recvmsg(LARGEST_BYTES, _ROOM_FOR_NOTES)
            except BlockingIOError:
                return
            except OSError:
                continue  # an answer "port unreachable" to something sent before
            yield Datagram(data, f"{host}:{port}", _received_ns(notes))

    def close(self) -> None:
        self._socket.close()


def _received_ns(notes: list[tuple[int, int, bytes]]) -> int:
    """When the kernel had a datagram; now, where it does not say, or its clock was set meanwhile."""
    monotonic_ns, unix_ns = _now_ns()
    for _, kind, data in notes:
        if kind == _SO_TIMESTAMPNS and len(data) == _TIMESPEC.size:
            seconds, nanoseconds = _TIMESPEC.unpack(data)
            age_ns: int = unix_ns - seconds * NS_PER_S - nanoseconds
            return monotonic_ns - age_ns if 0 <= age_ns < OLDEST_NS else monotonic_ns
    return monotonic_ns


def _now_ns() -> tuple[int, int]:
    """Monotonic and Unix time of one moment, even if the process was put aside between two looks."""
    while True:
        monotonic_ns, unix_ns, again_ns = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        if again_ns - monotonic_ns < ONE_MOMENT_NS:
            return monotonic_ns, unix_ns
