"""Keeps one service running from its systemd unit, on a machine without systemd.

    python -m swarm.services.supervisor UNIT INSTANCE STATE

STATE is where what is known of the service is written, as JSON: `state` is starting, active, restarting,
failed or stopped. STATE.lock is locked for as long as the supervisor lives, and holds its process id.
"""

from __future__ import annotations

import ctypes
import fcntl
import json
import os
import secrets
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

from swarm.errors import UserError, guarded
from swarm.services.unit import Unit

LOOK_EVERY_S = 0.1
"""How late the end of a process is seen."""
PR_SET_PDEATHSIG = 1
"""From linux/prctl.h: the signal that a process gets when its parent ends."""


class Supervisor:
    """One service: started, watched, and started again with growing pauses if its unit says so."""

    def __init__(self, unit: Unit, state: Path) -> None:
        self._unit = unit
        self._state_file = state
        self._told_to_stop = False
        self._restarts = 0
        self._state: dict[str, object] = {}
        self._address = f"swarm-{secrets.token_hex(8)}"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(f"\0{self._address}")
        self._socket.settimeout(LOOK_EVERY_S)

    def run(self) -> None:
        """Until the service ends for good, or the supervisor is told to stop by SIGTERM or SIGINT."""
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._stop)
        pause_s = self._unit.restart_after_s
        while True:
            began_s = time.monotonic()
            code = self._once()
            if self._told_to_stop or not self._unit.starts_again(code):
                self._tell("stopped" if self._told_to_stop or code == 0 else "failed", code=code)
                return
            if time.monotonic() - began_s > self._unit.restart_after_at_most_s:
                pause_s = self._unit.restart_after_s
            self._restarts += 1
            self._tell("restarting", code=code)
            self._pause(pause_s)
            pause_s = min(2 * pause_s, self._unit.restart_after_at_most_s)

    def _stop(self, *_: object) -> None:
        self._told_to_stop = True

    def _pause(self, pause_s: float) -> None:
        """Nobody speaks meanwhile: to listen is to wait, and a signal is heeded soon."""
        until_s = time.monotonic() + pause_s
        while not self._told_to_stop and time.monotonic() < until_s:
            self._heard()

    def _once(self) -> int:
        """Start the process and watch it until it has ended; its exit code."""
        environment = {
            **os.environ,
            **self._unit.environment,
            "NOTIFY_SOCKET": f"@{self._address}",
            "WATCHDOG_USEC": str(round(self._unit.watchdog_s * 1e6)),
        }
        process = subprocess.Popen(
            self._unit.command,
            cwd=self._unit.working_directory,
            env=environment,
            stdin=subprocess.DEVNULL,
            preexec_fn=_end_with_parent,
        )
        self._tell("starting", pid=process.pid)
        self._watch(process)
        return process.wait()

    def _watch(self, process: subprocess.Popen[bytes]) -> None:
        """Until the process ends; one that is not ready in time, or falls silent, is ended."""
        deadline_s = time.monotonic() + (self._unit.start_within_s or float("inf"))
        while process.poll() is None:
            if self._told_to_stop:
                self._end(process, signal.SIGTERM)
                return
            if time.monotonic() > deadline_s:
                print("the service is silent: it is ended", file=sys.stderr, flush=True)
                self._end(process, signal.SIGABRT)
                return
            for told in self._heard():
                if told == "READY=1":
                    self._tell("active", pid=process.pid)
                if told.startswith("STATUS="):
                    self._tell(str(self._state["state"]), pid=process.pid, status=told[7:])
                if told in ("READY=1", "WATCHDOG=1"):
                    deadline_s = time.monotonic() + (self._unit.watchdog_s or float("inf"))

    def _heard(self) -> list[str]:
        try:
            return self._socket.recv(4096).decode("utf-8", "replace").splitlines()
        except TimeoutError:
            return []

    def _end(self, process: subprocess.Popen[bytes], number: signal.Signals) -> None:
        process.send_signal(number)
        try:
            process.wait(self._unit.stop_within_s)
        except subprocess.TimeoutExpired:
            process.kill()

    def _tell(self, state: str, **more: object) -> None:
        self._state = {"state": state, "restarts": self._restarts, **more}
        temporary = self._state_file.with_suffix(".new")
        temporary.write_text(json.dumps(self._state), encoding="utf-8")
        temporary.replace(self._state_file)


def _end_with_parent() -> None:
    """A process does not outlive its supervisor, also one that is killed."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def main() -> None:
    """Entry point: a unit file, the instance, and where the state is written."""
    sys.exit(guarded(lambda: _supervise(sys.argv[1:])))


def _supervise(words: list[str]) -> None:
    if len(words) != 3:
        raise UserError("say UNIT INSTANCE STATE")
    unit, instance, state = Path(words[0]), words[1], Path(words[2])
    with state.with_suffix(".lock").open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise UserError(f"{state}: another supervisor runs this service") from error
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        Supervisor(Unit.read(unit, instance), state).run()


if __name__ == "__main__":
    main()
