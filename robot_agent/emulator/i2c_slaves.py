"""The two robots that answer at I2C address 0x1F of a Pi-puck: an e-puck2, and an e-puck1 by York."""

from __future__ import annotations

import errno
import struct
from functools import reduce
from operator import xor
from typing import Protocol

import numpy as np

from robot_agent.emulator.robot import EmulatedRobot

ADDRESS = 0x1F
READING_BYTES = 47
COMMAND_BYTES = 20


class I2cSlave(Protocol):
    """A device on the bus."""

    def transfer(self, address: int, written: bytes, count: int, t_ns: int) -> bytes:
        """Take what the master writes, then give `count` bytes. OSError if the transfer fails."""


def checksum(data: bytes) -> int:
    """All bytes combined by exclusive or."""
    return reduce(xor, data, 0)


class GumstixSlave:
    """The e-puck2's block protocol (e-puck2_main-processor, branch gumstix, gumstix.c).

    A command with a wrong checksum is not obeyed but still gets a valid reply; the first reply is all
    zeros, whose checksum is right.
    """

    def __init__(self, robot: EmulatedRobot, rng: np.random.Generator) -> None:
        self._robot = robot
        self._rng = rng
        self._ready = False

    def transfer(self, address: int, written: bytes, count: int, t_ns: int) -> bytes:
        fail_sometimes(self._robot, address, self._rng)
        if len(written) == COMMAND_BYTES and checksum(written[:-1]) == written[-1]:
            self._obey(written, t_ns)
        reply = self._reply(t_ns) if self._ready else bytes(READING_BYTES)
        self._ready = True
        return self._spoilt(reply)[:count].ljust(count, b"\xff") if count else b""

    def _obey(self, command: bytes, t_ns: int) -> None:
        left, right, _, lights = struct.unpack_from("<hhBB", command)
        self._robot.drive(left, right, t_ns)
        ring = sum(1 << 2 * number for number in range(4) if lights >> number & 1)
        colours = sum(1 << 2 * n + 1 for n in range(4) if any(command[6 + 3 * n : 9 + 3 * n]))
        self._robot.lights = ring | colours

    def _reply(self, t_ns: int) -> bytes:
        robot = self._robot
        body = struct.pack("<8H8H", *robot.proximity(t_ns), *robot.ambient()) + bytes(8)
        body += struct.pack("<BHHB", robot.selector, *robot.counters(t_ns), 0)
        return body + bytes((checksum(body),))

    def _spoilt(self, reply: bytes) -> bytes:
        chance = self._robot.faults.bad_checksum
        if not chance or self._rng.random() >= chance:
            return reply
        bit = int(self._rng.integers(8 * len(reply)))
        spoilt = bytearray(reply)
        spoilt[bit // 8] ^= 1 << bit % 8
        return bytes(spoilt)


class YorkSlave:
    """York's e-puck1 firmware: 16-bit little-endian registers (pi-puck-e-puck1, i2c_slave.c).

    A counter's bytes are sent one after the other from live memory, so that a step in between tears it:
    at a carry it is 256 off. Infra-red readings need register 6 set.
    """

    def __init__(self, robot: EmulatedRobot, rng: np.random.Generator) -> None:
        self._robot = robot
        self._rng = rng
        self._speeds = [0, 0]
        self._infra_red = False
        self._tears: dict[int, int] = {}

    def transfer(self, address: int, written: bytes, count: int, t_ns: int) -> bytes:
        fail_sometimes(self._robot, address, self._rng)
        if len(written) > 1:
            self._write(written[0], written[1:], t_ns)
        return self._read(written[0] if written else 0, t_ns).ljust(count, b"\x00")[:count]

    def _write(self, register: int, data: bytes, t_ns: int) -> None:
        value = int.from_bytes(data[:2], "little", signed=len(data) > 1)
        robot = self._robot
        if register == 0:
            robot.lights = robot.lights & 0x300 | data[0]
        elif register == 1:
            robot.lights = robot.lights & 0xFF | (data[0] & 1) << 9 | (data[0] & 2) << 7
        elif register in (2, 3) and len(data) == 2:
            self._speeds[register - 2] = value
            robot.drive(self._speeds[0], self._speeds[1], t_ns)
        elif register == 6:
            self._infra_red = bool(data[0])

    def _read(self, register: int, t_ns: int) -> bytes:
        robot = self._robot
        if register in (2, 3):
            return struct.pack("<h", self._speeds[register - 2])
        if register in (4, 5):
            return self._torn(register, robot.counters(t_ns)[register - 4])
        if 7 <= register <= 14:
            return struct.pack("<h", robot.proximity(t_ns)[register - 7] if self._infra_red else 0)
        return struct.pack("<H", robot.ambient()[register - 15] if 15 <= register <= 22 else 0)

    def _torn(self, register: int, count: int) -> bytes:
        """The low byte of one moment and the high byte of the next: when the wheel's next step is a carry, it
        comes in between with a chance of 1 in 2. One carry comes once."""
        speed = self._robot.commanded[register - 4]
        later = count + (speed > 0) - (speed < 0)
        tears = later >> 8 != count >> 8 and self._tears.get(register) != count
        if tears and self._rng.integers(2):
            self._tears[register] = count
            count = later & 0xFF00 | count & 0xFF
        return struct.pack("<H", count & 0xFFFF)


def fail_sometimes(robot: EmulatedRobot, address: int, rng: np.random.Generator) -> None:
    """OSError for an address where nobody answers, and now and then for no reason."""
    if address != ADDRESS or (robot.faults.failure and rng.random() < robot.faults.failure):
        raise OSError(errno.EREMOTEIO, "Remote I/O error")
