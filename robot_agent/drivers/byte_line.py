"""A line of bytes, a serial port or a socket, with a limit to every wait."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Callable
from typing import Protocol

from robot_agent.drivers.robot_link import LinkError

WRITE_WITHIN_S = 0.1
"""A line that takes no byte for so long is taken for lost: a command is 64 bytes at most."""
READ_AT_ONCE = 65_536


class Port(Protocol):
    """What pyserial's ports and Python's sockets have in common."""

    def fileno(self) -> int: ...

    def close(self) -> None: ...


class ByteLine:
    """Reads and writes an open port that does not block."""

    def __init__(self, port: Port, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._port = port
        self._monotonic_s = monotonic_s
        os.set_blocking(port.fileno(), False)

    def send(self, data: bytes) -> None:
        """Write all of it, in one call if the line takes it. LinkError if the line is gone or stuck."""
        until_s = self._monotonic_s() + WRITE_WITHIN_S
        while data:
            _, ready, _ = select.select([], [self._port], [], max(0.0, until_s - self._monotonic_s()))
            if not ready:
                raise LinkError("the line takes no more bytes")
            try:
                data = data[os.write(self._port.fileno(), data) :]
            except OSError as error:
                raise LinkError(f"cannot write: {error.strerror}") from error

    def receive(self, within_s: float) -> bytes:
        """What is there, or comes within the time; nothing if nothing comes. LinkError at its end."""
        ready, _, _ = select.select([self._port], [], [], within_s)
        if not ready:
            return b""
        try:
            data = os.read(self._port.fileno(), READ_AT_ONCE)
        except OSError as error:
            raise LinkError(f"cannot read: {error.strerror}") from error
        if not data:
            raise LinkError("the other end has closed the line")
        return data

    def receive_until(self, has_all: Callable[[bytes], bool], within_s: float) -> bytes:
        """What comes until it is complete, or until the time is over."""
        until_s = self._monotonic_s() + within_s
        data = b""
        while not has_all(data) and (left_s := until_s - self._monotonic_s()) > 0:
            data += self.receive(left_s)
        return data

    def drain(self, quiet_s: float) -> bytes:
        """Take away what comes until nothing has come for a while (at most twenty times that)."""
        data = b""
        for _ in range(20):
            more = self.receive(quiet_s)
            if not more:
                break
            data += more
        return data

    def close(self) -> None:
        self._port.close()
