"""The paper's own Linux board: 25 words each way in one SPI transfer with the robot below.

Source: W. Liu's Player driver for the board of Liu and Winfield (2011). Needs spidev (the `spi` extra).
"""

from __future__ import annotations

import struct
from typing import Protocol

from robot_agent.drivers.motors import EPUCK1
from robot_agent.drivers.robot_link import Actuators, LinkError, Reading, ReplyError, require_agreement

DEVICE = "/dev/spidev1.0"
EMULATED = "unix:"
MODE = 1
SPEED_HZ = 20_000_000
BITS = 16
SET_MOTORS, SET_LIGHTS, READ_INFRA_RED = 1, 2, 32
RESERVED_WORDS = 21
"""The robot's processor sees the transfer one word late, hence a spare word at the end."""
TRANSFERS_BEFORE_LOST = 25
"""So many failures in a row, and the robot counts as gone."""
MOST_STEPS_BETWEEN = 4
"""Two transfers follow each other within 1 ms."""
_REPLY = struct.Struct("<8H3h3H8HHHH")


class SpiDevice(Protocol):
    """What is used of spidev's SpiDev."""

    def xfer2(self, values: list[int]) -> list[int]: ...

    def close(self) -> None: ...


def command_bytes(actuators: Actuators) -> bytes:
    """The 50 bytes of a transfer, little-endian as the processor of the board is."""
    commands = SET_MOTORS | SET_LIGHTS | READ_INFRA_RED
    head = struct.pack("<4h", commands, actuators.left, actuators.right, actuators.lights)
    return head + bytes(2 * RESERVED_WORDS)


def parsed_reply(reply: bytes) -> Reading:
    """The reading in the 50 bytes of an answer. There is no checksum: what a sensor cannot show is refused.

    The battery's unit is not documented, so the volts stay unknown.
    """
    if len(reply) != _REPLY.size:
        raise ReplyError(f"{len(reply)} bytes of {_REPLY.size} came")
    words = _REPLY.unpack(reply)
    echoes, ambient = words[:8], words[14:22]
    if any(level > 4095 for level in ambient):
        raise ReplyError(f"ambient light {ambient} has more than 12 bits")
    left, right = words[22:24]
    return Reading(left, right, echoes).checked()


class SpiLink:
    """The robot below the board."""

    motors = EPUCK1
    identity = "e-puck below a Linux board (SPI, lpuck protocol)"

    def __init__(self, device: SpiDevice) -> None:
        self._device = device
        self._failed = 0
        try:
            self.exchange(Actuators())
        except ReplyError as error:
            raise LinkError(f"no robot answers over SPI: {error}") from error

    def exchange(self, actuators: Actuators) -> Reading:
        """Two transfers: there is no checksum, so that the counters of both have to agree."""
        command = list(command_bytes(actuators))
        try:
            first = parsed_reply(bytes(self._device.xfer2(command)))
            reading = parsed_reply(bytes(self._device.xfer2(command)))
            require_agreement(first, reading, MOST_STEPS_BETWEEN)
        except OSError as error:
            self._fail(ReplyError(f"the transfer failed: {error}"))
        except ReplyError as error:
            self._fail(error)
        self._failed = 0
        return reading

    def _fail(self, reason: ReplyError) -> None:
        self._failed += 1
        if self._failed >= TRANSFERS_BEFORE_LOST:
            raise LinkError(str(reason)) from reason
        raise reason

    def close(self) -> None:
        self._device.close()


def open_link(address: str) -> SpiLink:
    """The robot at a device such as /dev/spidev1.0 (also if empty); `unix:FILE` is an emulated one."""
    if not address.startswith(EMULATED):
        return SpiLink(_device(address or DEVICE))
    from robot_agent.emulator.buses import remote_spidev

    try:
        return SpiLink(remote_spidev(address.removeprefix(EMULATED)))
    except OSError as error:
        raise LinkError(f"cannot open {address}: {error}") from error


def _device(path: str) -> SpiDevice:
    import spidev

    device = spidev.SpiDev()
    try:
        device.open_path(path)
    except OSError as error:
        raise LinkError(f"cannot open {path}: {error}") from error
    device.mode, device.bits_per_word, device.max_speed_hz = MODE, BITS, SPEED_HZ
    opened: SpiDevice = device
    return opened
