"""Buses with an emulated robot, shaped like smbus2's and spidev's; the robot may be in another process."""

from __future__ import annotations

import ctypes
import errno
import socket
import struct
from collections.abc import Callable
from typing import Any

I2cTransfer = Callable[[int, bytes, int], bytes]
"""Address, bytes to write, number of bytes to read. Raises OSError."""
SpiTransfer = Callable[[bytes], bytes]

_REQUEST = struct.Struct("<BBB")
SPI = 0
"""The address in a request that means the SPI device: no I2C device has it."""
_I2C_READ = 1


class EmulatedSmbus:
    """An I2C bus with `i2c_rdwr`, as smbus2's SMBus has it."""

    def __init__(self, transfer: I2cTransfer, close: Callable[[], None] = lambda: None) -> None:
        self._transfer = transfer
        self.close = close

    def i2c_rdwr(self, *messages: Any) -> None:
        """One transaction: what the messages write, then as many bytes as they read."""
        written = b"".join(bytes(message) for message in messages if not message.flags & _I2C_READ)
        reading = [message for message in messages if message.flags & _I2C_READ]
        data = self._transfer(messages[0].addr, written, sum(message.len for message in reading))
        for message in reading:
            ctypes.memmove(message.buf, data[: message.len], message.len)
            data = data[message.len :]


class EmulatedSpiDev:
    """An SPI device with `xfer2`, as spidev's SpiDev has it."""

    def __init__(self, transfer: SpiTransfer, close: Callable[[], None] = lambda: None) -> None:
        self._transfer = transfer
        self.close = close

    def xfer2(self, values: list[int]) -> list[int]:
        """Full duplex: as many bytes back as there."""
        return list(self._transfer(bytes(values)))


class RemoteTransfers:
    """Transfers over a Unix socket to the emulator that serves it. Raises OSError when it is gone."""

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._socket.connect(path)
        except OSError:
            self._socket.close()
            raise

    def i2c(self, address: int, written: bytes, count: int) -> bytes:
        self._socket.send(_REQUEST.pack(address, len(written), count) + written)
        reply = self._socket.recv(1 << 16)
        if not reply:
            raise OSError(errno.ENODEV, "the emulated bus is gone")
        if reply[0]:
            raise OSError(reply[0], "emulated bus error")
        return reply[1:]

    def spi(self, sent: bytes) -> bytes:
        return self.i2c(SPI, sent, len(sent))

    def close(self) -> None:
        self._socket.close()


def served_transfer(request: bytes, i2c: I2cTransfer | None, spi: SpiTransfer | None) -> bytes:
    """The answer to one request of `RemoteTransfers`: an error number or 0, then what was read."""
    address, length, count = _REQUEST.unpack_from(request)
    written = request[_REQUEST.size : _REQUEST.size + length]
    try:
        if address == SPI and spi:
            return b"\x00" + spi(written)
        if address != SPI and i2c:
            return b"\x00" + i2c(address, written, count)
    except OSError as error:
        return bytes((error.errno or errno.EIO,))
    return bytes((errno.ENXIO,))


def remote_smbus(path: str) -> EmulatedSmbus:
    """The emulated I2C bus behind a Unix socket."""
    transfers = RemoteTransfers(path)
    return EmulatedSmbus(transfers.i2c, transfers.close)


def remote_spidev(path: str) -> EmulatedSpiDev:
    """The emulated SPI device behind a Unix socket."""
    transfers = RemoteTransfers(path)
    return EmulatedSpiDev(transfers.spi, transfers.close)
