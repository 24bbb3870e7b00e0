"""A Pi-puck's robot over I2C: the e-puck2's block protocol or York's e-puck1 registers, at one address.

Sources: e-puck2_main-processor, branch gumstix, gumstix.c; pi-puck-e-puck1, i2c_slave.c. Needs smbus2 (the
`i2c` extra).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from fcntl import ioctl
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Any, Protocol

from robot_agent.drivers.motors import EPUCK2, YORK
from robot_agent.drivers.robot_link import Actuators, LinkError, Reading, ReplyError, wrapped_difference

ADDRESS = 0x1F
BUSES = ("12", "4")
"""The robot's bus has number 12 on new kernels and 4 on older ones."""
EMULATED = "unix:"
TIMEOUT_REQUEST = 0x0702
TIMEOUT_TENS_OF_MS = 2
"""Linux's I2C_TIMEOUT; GCtronic's example sets 20 ms on the Pi-puck."""
ATTEMPTS = 3
"""About 1 transfer in 1000 fails on a Pi-puck."""
TRANSFERS_BEFORE_LOST = 25
"""So many failures in a row, and the robot counts as gone."""
READING_BYTES = 47
SELECTOR = 10
"""The position in which the robot answers at all; zeros with a right checksum do not have it."""
BRIGHT = 50
"""Of 100: bright enough to see, half the current."""
MOST_STEPS_BETWEEN = 20
"""A counter read twice moves by less (20 ms at full speed); a torn one is 256 off."""
BATTERY = Path("/sys/bus/i2c/devices/11-0048/iio:device0")
BATTERY_SCALE_V = 500.0
"""The converter beside the bus: in_voltage0_raw x in_voltage0_scale / 500 are volts."""

BatteryV = Callable[[], float]
"""The battery's volts, 0 if unknown: the robot's own answers do not have them."""


class Smbus(Protocol):
    """What is used of smbus2's SMBus."""

    def i2c_rdwr(self, *messages: Any) -> None: ...

    def close(self) -> None: ...


class I2cBus:
    """Transactions with the robot, with a repeated start, on an open bus."""

    def __init__(self, bus: Smbus) -> None:
        import smbus2

        self._bus = bus
        self._message = smbus2.i2c_msg
        self.close = bus.close

    def transfer(self, written: bytes, count: int) -> bytes:
        """Write, then read so many bytes. Raises OSError."""
        messages = [self._message.write(ADDRESS, written)]
        if count:
            messages.append(self._message.read(ADDRESS, count))
        self._bus.i2c_rdwr(*messages)
        return bytes(messages[-1]) if count else b""


def checksum(data: bytes) -> int:
    """All bytes combined by exclusive or."""
    return reduce(xor, data, 0)


def command_bytes(actuators: Actuators) -> bytes:
    """The 20 bytes of the block protocol. Settings stay 0; the body's light cannot be told here."""
    ring = actuators.lights & 0xFF
    leds = sum((ring >> 2 * number & 1) << number for number in range(4))
    colours = b"".join(bytes((BRIGHT * (ring >> 2 * number + 1 & 1), 0, 0)) for number in range(4))
    body = struct.pack("<hhBB", actuators.left, actuators.right, 0, leds) + colours + b"\x00"
    return body + bytes((checksum(body),))


def parsed_reply(reply: bytes, battery_v: float) -> Reading:
    """The reading in the 47 bytes of the block protocol. ReplyError if it is none."""
    if len(reply) != READING_BYTES or checksum(reply[:-1]) != reply[-1]:
        raise ReplyError("the checksum is wrong")
    if reply[40] & 0x0F != SELECTOR:
        raise ReplyError(f"the selector shows {reply[40] & 0x0F}, not {SELECTOR}")
    left, right = struct.unpack_from("<HH", reply, 41)
    return Reading(left, right, struct.unpack_from("<8H", reply), battery_v, SELECTOR).checked()


class BlockLink:
    """An e-puck2: 20 bytes there and 47 back in one transaction."""

    motors = EPUCK2
    identity = "e-puck2 on a Pi-puck (block protocol), selector 10"

    def __init__(self, bus: I2cBus, battery_v: BatteryV) -> None:
        self._bus = bus
        self._battery_v = battery_v
        self._failed = 0
        self.exchange(Actuators())

    def exchange(self, actuators: Actuators) -> Reading:
        command, reason = command_bytes(actuators), ReplyError("nothing was tried")
        for _ in range(ATTEMPTS):
            try:
                reading = parsed_reply(self._bus.transfer(command, READING_BYTES), self._battery_v())
            except OSError as error:
                reason = ReplyError(f"the transfer failed: {error}")
            except ReplyError as error:
                reason = error
            else:
                self._failed = 0
                return reading
        self._failed = _counted(self._failed, reason)
        raise reason

    def close(self) -> None:
        self._bus.close()


class RegisterLink:
    """An e-puck1 with York's firmware: one register a transaction."""

    motors = YORK
    identity = "e-puck1 on a Pi-puck (York's registers)"

    RING, INNER, LEFT, RIGHT, LEFT_STEPS, RIGHT_STEPS, INFRA_RED, ECHOES = range(8)

    def __init__(self, bus: I2cBus, battery_v: BatteryV) -> None:
        self._bus = bus
        self._battery_v = battery_v
        self._failed = 0
        self._lights = 0
        self.exchange(Actuators())
        self._write(self.INFRA_RED, b"\x01")
        self._write(self.RING, b"\x00")
        self._write(self.INNER, b"\x00")

    def exchange(self, actuators: Actuators) -> Reading:
        try:
            self._write(self.LEFT, struct.pack("<h", actuators.left))
            self._write(self.RIGHT, struct.pack("<h", actuators.right))
            self._light(actuators.lights)
            left, right = self._counter(self.LEFT_STEPS), self._counter(self.RIGHT_STEPS)
            echoes = tuple(max(0, self._read(self.ECHOES + number, "<h")) for number in range(8))
            reading = Reading(left, right, echoes, self._battery_v()).checked()
        except ReplyError as error:
            self._failed = _counted(self._failed, error)
            raise
        self._failed = 0
        return reading

    def _light(self, lights: int) -> None:
        if lights != self._lights:
            self._write(self.RING, bytes((lights & 0xFF,)))
            self._write(self.INNER, bytes((lights >> 9 & 1 | lights >> 7 & 2,)))
            self._lights = lights

    def _counter(self, register: int) -> int:
        """Its two bytes come from different moments and may not fit: two readings have to agree."""
        before = self._read(register, "<H")
        for _ in range(ATTEMPTS):
            count = self._read(register, "<H")
            if abs(wrapped_difference(count, before)) <= MOST_STEPS_BETWEEN:
                return count
            before = count
        raise ReplyError(f"register {register} shows something else each time")

    def _write(self, register: int, data: bytes) -> None:
        self._repeated(bytes((register,)) + data, 0)

    def _read(self, register: int, kind: str) -> int:
        value: int = struct.unpack(kind, self._repeated(bytes((register,)), 2))[0]
        return value

    def _repeated(self, written: bytes, count: int) -> bytes:
        reason = OSError()
        for _ in range(ATTEMPTS):
            try:
                return self._bus.transfer(written, count)
            except OSError as error:
                reason = error
        raise ReplyError(f"the transfer failed {ATTEMPTS} times: {reason}") from reason

    def close(self) -> None:
        self._bus.close()


def probed(bus: I2cBus, battery_v: BatteryV) -> BlockLink | RegisterLink:
    """The protocol that the robot speaks. Block first: for York's registers its zeros are harmless.

    LinkError if neither is spoken.
    """
    for kind in (BlockLink, RegisterLink):
        try:
            return kind(bus, battery_v)
        except ReplyError:
            continue
    raise LinkError(f"no robot answers at address {ADDRESS:#04x}: is its selector at 10, is it switched on?")


def _counted(failed: int, reason: ReplyError) -> int:
    """One failure more; LinkError when it has been too many in a row."""
    if failed + 1 >= TRANSFERS_BEFORE_LOST:
        raise LinkError(str(reason)) from reason
    return failed + 1


def open_link(address: str) -> BlockLink | RegisterLink:
    """The robot on bus `address` (a number), or on the one that has a robot if it is empty; `unix:FILE` is
    an emulated bus. LinkError if there is none."""
    reasons = []
    for name in [address] if address else BUSES:
        try:
            return _opened(name)
        except (LinkError, OSError, ValueError) as error:
            reasons.append(f"bus {name}: {error}")
    raise LinkError("; ".join(reasons))


def _opened(name: str) -> BlockLink | RegisterLink:
    if name.startswith(EMULATED):
        from robot_agent.emulator.buses import remote_smbus

        bus = I2cBus(remote_smbus(name.removeprefix(EMULATED)))
    else:
        bus = I2cBus(_bus_of_this_machine(int(name)))
    try:
        return probed(bus, _battery_v)
    except BaseException:
        bus.close()
        raise


def _bus_of_this_machine(number: int) -> Smbus:
    """A bus that gives a transfer up soon: one that fails would else block for a second."""
    import smbus2

    bus = smbus2.SMBus(number)
    if bus.fd is not None:
        ioctl(bus.fd, TIMEOUT_REQUEST, TIMEOUT_TENS_OF_MS)
    opened: Smbus = bus
    return opened


def _battery_v() -> float:
    """0 where the Pi-puck's converter is not to be found: the packet has no battery."""
    try:
        raw = float((BATTERY / "in_voltage0_raw").read_text())
        return raw * float((BATTERY / "in_voltage0_scale").read_text()) / BATTERY_SCALE_V
    except (OSError, ValueError):
        return 0.0
