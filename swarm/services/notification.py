"""What a process tells whoever started it as a service: that it is ready, what it is about, that it goes on.

The protocol is sd_notify(3)'s: lines of NAME=VALUE in a datagram to the socket that NOTIFY_SOCKET names.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import suppress


class ServiceManager:
    """Who started this process, and wants to hear from it; a process that nobody waits for tells nothing."""

    def __init__(
        self, address: str = "", watchdog_s: float = 0.0, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self._address = f"\0{address[1:]}" if address.startswith("@") else address
        self._every_s = watchdog_s / 2
        self._monotonic = monotonic
        self._told_s = -self._every_s
        self._status = ""

    @classmethod
    def of_environment(cls, environment: Mapping[str, str] = os.environ) -> ServiceManager:
        """The one that the environment names. A watchdog that watches another process is not this one's."""
        watched = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
        watchdog_us = environment.get("WATCHDOG_USEC", "0") if watched else "0"
        return cls(environment.get("NOTIFY_SOCKET", ""), int(watchdog_us) / 1e6)

    def ready(self) -> None:
        """Everything that can be wrong with this process alone has been looked at."""
        self._tell("READY=1")

    def about(self, status: str) -> None:
        """What the process is about, for people who ask; said again only when it changes."""
        if status != self._status:
            self._status = status
            self._tell(f"STATUS={status}")

    def going_on(self) -> None:
        """The main loop runs: call it at every turn. It is told twice in the watchdog's time."""
        if self._every_s and self._monotonic() - self._told_s >= self._every_s:
            self._told_s = self._monotonic()
            self._tell("WATCHDOG=1")

    def _tell(self, text: str) -> None:
        """A manager that is gone, or too busy, must not end what it manages."""
        if self._address:
            with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
                sender.setblocking(False)
                sender.sendto(text.encode(), self._address)
