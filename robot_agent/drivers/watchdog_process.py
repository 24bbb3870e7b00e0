"""Starts a robot's watchdog and speaks with it."""

from __future__ import annotations

import contextlib
import select
import socket
import subprocess

from robot_agent.drivers.epuck_body import WatchdogEndedError
from robot_agent.drivers.watchdog_messages import LONGEST_DATAGRAM
from swarm.interpreter import child_environment, module_command

END_WITHIN_S = 2.0
"""A watchdog stops its robot in one exchange; over a lost link it tries for ten seconds, by itself."""


class WatchdogProcess:
    """A watchdog in a process of its own, which neither the end of the agent nor its signals end."""

    def __init__(self, opener: str, address: str, speed: float) -> None:
        self._arguments = (opener, address, str(speed))
        self._start()

    def send(self, message: bytes) -> None:
        # A watchdog that is gone is found when its answer is asked for; a full socket is a lost link.
        with contextlib.suppress(OSError):
            self._socket.send(message, socket.MSG_DONTWAIT)

    def receive(self, within_s: float) -> bytes | None:
        ready, _, _ = select.select([self._socket], [], [], within_s)
        if not ready:
            return None
        try:
            message = self._socket.recv(LONGEST_DATAGRAM)
        except OSError:
            message = b""
        if not message:
            raise WatchdogEndedError
        return message

    def restart(self) -> None:
        self._socket.close()
        self._process.wait()
        self._start()

    def close(self) -> None:
        self._socket.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(END_WITHIN_S)

    @property
    def pid(self) -> int:
        """The process's id."""
        return self._process.pid

    def _start(self) -> None:
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            number = theirs.fileno()
            command = module_command("robot_agent.drivers.watchdog", str(number), *self._arguments)
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                pass_fds=[number],
                start_new_session=True,
                env=child_environment(),
            )
