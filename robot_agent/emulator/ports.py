"""Where an emulated robot can be reached: a pseudo-terminal, a TCP port, a Unix socket in place of a bus."""

from __future__ import annotations

import os
import select
import socket
import threading
import tty
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from robot_agent.emulator.asercom import Asercom
from robot_agent.emulator.buses import I2cTransfer, SpiTransfer, served_transfer
from robot_agent.emulator.esp32 import Esp32
from robot_agent.emulator.faults import Faults
from swarm.clock import NS_PER_S

POLL_S = 0.002
"""Real time between two looks at the clock: a tenth of the Wi-Fi firmware's cycle."""
LOOPBACK = "127.0.0.1"
EMULATED = "unix:"
"""What the address of an emulated bus begins with."""

Now = Callable[[], int]


class Port(ABC):
    """Serves one robot on a thread of its own. `lock` is held whenever the robot's state is touched."""

    def __init__(self, now_ns: Now, lock: threading.Lock, faults: Faults) -> None:
        self._now_ns = now_ns
        self._lock = lock
        self._faults = faults
        self._began_ns = now_ns()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    @property
    @abstractmethod
    def address(self) -> str:
        """What a driver is to be given as the robot's address, once it is served."""

    def start(self) -> None:
        """Serve from now on."""
        self._open()
        self._thread.start()

    def close(self) -> None:
        """Stop serving; whoever is connected finds the link gone."""
        self._ended.set()
        self._thread.join()
        self._shut()

    def _serve(self) -> None:
        up = True
        while not self._ended.is_set():
            is_up = self._is_up()
            if up and not is_up:
                self._shut()
            elif is_up and not up:
                self._open()
            up = is_up
            if up:
                with suppress(OSError):
                    self._serve_once()
            else:
                self._ended.wait(POLL_S)

    def _is_up(self) -> bool:
        """Whether the link is there now, with the fault that drops it."""
        if not self._faults.drop_after_s:
            return True
        cycle_s = self._faults.drop_after_s + self._faults.drop_for_s
        age_s = (self._now_ns() - self._began_ns) / NS_PER_S
        return age_s % cycle_s < self._faults.drop_after_s

    @abstractmethod
    def _open(self) -> None:
        """Be reachable."""

    @abstractmethod
    def _shut(self) -> None:
        """Be not."""

    @abstractmethod
    def _serve_once(self) -> None:
        """Take in and give out what there is; wait a little if there is nothing."""


class SerialPort(Port):
    """A pseudo-terminal; `at` is a link to it that stays when the line drops and returns."""

    def __init__(
        self, firmware: Asercom, at: Path, now_ns: Now, lock: threading.Lock, faults: Faults
    ) -> None:
        super().__init__(now_ns, lock, faults)
        self._firmware = firmware
        self._at = at

    @property
    def address(self) -> str:
        return str(self._at)

    def _open(self) -> None:
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        self._at.unlink(missing_ok=True)
        self._at.symlink_to(os.ttyname(self._theirs))

    def _shut(self) -> None:
        self._at.unlink(missing_ok=True)
        for end in (self._ours, self._theirs):
            with suppress(OSError):
                os.close(end)

    def _serve_once(self) -> None:
        ready, _, _ = select.select([self._ours], [], [], POLL_S)
        if ready:
            data = os.read(self._ours, 4096)
            with self._lock:
                answer = self._firmware.receive(data, self._now_ns())
            if answer:
                os.write(self._ours, answer)


class WifiPort(Port):
    """A TCP port at one of this machine's addresses; one client at a time."""

    def __init__(
        self, firmware: Esp32, place: tuple[str, int], now_ns: Now, lock: threading.Lock, faults: Faults
    ) -> None:
        super().__init__(now_ns, lock, faults)
        self._firmware = firmware
        self._host, self._number = place
        self._client: socket.socket | None = None

    @property
    def address(self) -> str:
        return f"{self._host}:{self._number}"

    def _open(self) -> None:
        self._listener = socket.create_server((self._host, self._number))
        self._number = self._listener.getsockname()[1]

    def _shut(self) -> None:
        self._listener.close()
        self._leave()

    def _serve_once(self) -> None:
        known = [self._listener] + ([self._client] if self._client else [])
        ready, _, _ = select.select(known, [], [], POLL_S)
        if self._listener in ready:
            self._leave()
            self._client, _ = self._listener.accept()
            with self._lock:
                self._firmware.connected()
        elif self._client and ready:
            self._take_in(self._client)
        if self._client:
            self._give_out(self._client)

    def _take_in(self, client: socket.socket) -> None:
        data = client.recv(4096)
        if not data:
            self._leave()
            return
        with self._lock:
            self._firmware.receive(data, self._now_ns())

    def _give_out(self, client: socket.socket) -> None:
        with self._lock:
            answer = self._firmware.stream(self._now_ns())
        if answer:
            try:
                client.sendall(answer)
            except OSError:
                self._leave()

    def _leave(self) -> None:
        if self._client:
            self._client.close()
            self._client = None


class BusPort(Port):
    """A Unix socket that takes the place of an I2C bus or an SPI device."""

    def __init__(
        self,
        i2c: I2cTransfer | None,
        spi: SpiTransfer | None,
        at: Path,
        now_ns: Now,
        lock: threading.Lock,
        faults: Faults,
    ) -> None:
        super().__init__(now_ns, lock, faults)
        self._i2c, self._spi = i2c, spi
        self._at = at
        self._clients: list[socket.socket] = []

    @property
    def address(self) -> str:
        return f"{EMULATED}{self._at}"

    def _open(self) -> None:
        self._at.unlink(missing_ok=True)
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._listener.bind(str(self._at))
        self._listener.listen()

    def _shut(self) -> None:
        for end in (self._listener, *self._clients):
            end.close()
        self._clients = []
        self._at.unlink(missing_ok=True)

    def _serve_once(self) -> None:
        ready, _, _ = select.select([self._listener, *self._clients], [], [], POLL_S)
        for end in ready:
            if end is self._listener:
                self._clients.append(end.accept()[0])
            else:
                self._answer(end)

    def _answer(self, client: socket.socket) -> None:
        request = client.recv(4096)
        if not request:
            client.close()
            self._clients.remove(client)
            return
        with self._lock:
            answer = served_transfer(request, self._i2c, self._spi)
        client.send(answer)
