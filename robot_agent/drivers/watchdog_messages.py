"""What an agent and its watchdog say to each other: datagrams over a socket pair."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

from robot_agent.drivers.motors import StepperMotors
from robot_agent.drivers.robot_link import Reading

LONGEST = 1024
"""Longer texts are cut."""
LONGEST_DATAGRAM = 65_536
"""An image has 38,400 bytes."""


@dataclass(frozen=True, slots=True)
class Request:
    """The agent asks for a reading and, if `drives`, commands wheels and lights until a deadline."""

    number: int
    drives: bool = False
    left: int = 0
    right: int = 0
    lights: int = 0
    deadline_ns: int = 0
    image: bool = False
    """Whether the camera on the link is to send a picture as well."""

    _LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I?hhHq?")
    SIZE: ClassVar[int] = 20

    def pack(self) -> bytes:
        return self._LAYOUT.pack(
            self.number,
            self.drives,
            self.left,
            self.right,
            self.lights,
            self.deadline_ns,
            self.image,
        )

    @classmethod
    def unpack(cls, data: bytes) -> Request:
        return cls(*cls._LAYOUT.unpack(data))


@dataclass(frozen=True, slots=True)
class Answer:
    """The watchdog's answer to a request: the reading, if the robot gave one, and when."""

    number: int
    t_ns: int
    reading: Reading | None
    failures: int
    refused: int

    KIND: ClassVar[bytes] = b"A"
    _LAYOUT: ClassVar[struct.Struct] = struct.Struct("<cIqII?HH8Hfb")

    @classmethod
    def of(cls, number: int, t_ns: int, reading: Reading | None, failures: int, refused: int) -> Answer:
        return cls(number & 0xFFFFFFFF, t_ns, reading, failures & 0xFFFFFFFF, refused & 0xFFFFFFFF)

    def pack(self) -> bytes:
        reading = self.reading or Reading(0, 0)
        return self._LAYOUT.pack(
            self.KIND,
            self.number,
            self.t_ns,
            self.failures,
            self.refused,
            self.reading is not None,
            reading.left,
            reading.right,
            *reading.proximity,
            reading.battery_v,
            reading.selector,
        )

    @classmethod
    def unpack(cls, data: bytes) -> Answer:
        _, number, t_ns, failures, refused, good, left, right, *rest = cls._LAYOUT.unpack(data)
        *echoes, battery_v, selector = rest
        reading = Reading(left, right, tuple(echoes), battery_v, selector) if good else None
        return cls(number, t_ns, reading, failures, refused)


@dataclass(frozen=True, slots=True)
class Identity:
    """The robot answered for the first time since the link was opened."""

    text: str
    motors: StepperMotors

    KIND: ClassVar[bytes] = b"I"
    _LAYOUT: ClassVar[struct.Struct] = struct.Struct("<cIII")

    def pack(self) -> bytes:
        motors = self.motors
        numbers = motors.timer_hz, motors.limit_steps_per_s, motors.extra_ticks
        return self._LAYOUT.pack(self.KIND, *numbers) + self.text.encode()[:LONGEST]

    @classmethod
    def unpack(cls, data: bytes) -> Identity:
        _, *numbers = cls._LAYOUT.unpack_from(data)
        return cls(data[cls._LAYOUT.size :].decode(errors="replace"), StepperMotors(*numbers))


@dataclass(frozen=True, slots=True)
class Event:
    """Something about the link that a person should be able to read in the log."""

    text: str

    KIND: ClassVar[bytes] = b"E"

    def pack(self) -> bytes:
        return self.KIND + self.text.encode()[:LONGEST]

    @classmethod
    def unpack(cls, data: bytes) -> Event:
        return cls(data[1:].decode(errors="replace"))


@dataclass(frozen=True, slots=True)
class Picture:
    """An image of the camera on the link: RGB565, the high byte first."""

    t_ns: int
    width: int
    height: int
    data: bytes

    KIND: ClassVar[bytes] = b"P"
    _LAYOUT: ClassVar[struct.Struct] = struct.Struct("<cqHH")

    def pack(self) -> bytes:
        return self._LAYOUT.pack(self.KIND, self.t_ns, self.width, self.height) + self.data

    @classmethod
    def unpack(cls, data: bytes) -> Picture:
        _, t_ns, width, height = cls._LAYOUT.unpack_from(data)
        return cls(t_ns, width, height, data[cls._LAYOUT.size :])


Said = Answer | Identity | Event | Picture


def unpacked(data: bytes) -> Said:
    """What the watchdog said."""
    kinds: dict[bytes, type[Said]] = {kind.KIND: kind for kind in (Answer, Identity, Event, Picture)}
    return kinds[data[:1]].unpack(data)
