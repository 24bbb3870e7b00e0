"""The serial firmware "advanced sercom" of e-puck1 (1.2.2) and e-puck2 (2.0), byte for byte.

Sources: e-puck-library, Asercom.c; e-puck2_main-processor, Asercom2.c. A command whose first byte is
positive is text up to a CR or LF; one whose first byte is negative begins a batch, which a zero ends.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from robot_agent.emulator.all_sensors import battery_raw, sensor_block
from robot_agent.emulator.robot import EmulatedRobot

GREETING = b'\f\aWELCOME to the SerCom protocol on e-Puck\r\nthe EPFL education robot type "H" for help\r\n'
VERSIONS = {
    "epuck1": b"v,Version 1.2.2 August 2008 GCtronic\r\nHW version: 13\r\n",
    "epuck2": b"v,Version 2.0 January 2018 GCtronic\r\nHW version: 0\r\n",
}
IMAGE_SIDE = 40
"""The image until `J` says otherwise: 40 x 40 RGB565."""

_ARGUMENTS = {"D": 4, "P": 4, "L": 2} | {"\x09": 19, "\x0a": 12, "\x0f": 1, "\x10": 1, "\x11": 1}
"""Bytes that follow a binary command; all others have none. 8 to 17 are the e-puck2's own."""
_LINE_ENDS = b"\r\n"


class Asercom:
    """Takes bytes from the serial line and returns what the firmware answers to them."""

    def __init__(self, robot: EmulatedRobot, model: str, rng: np.random.Generator) -> None:
        self._robot = robot
        self._version = VERSIONS[model]
        self._model = model
        self._rng = rng
        self._mode = ""
        self._waiting = bytearray()
        self._silent_once = True
        self._late = b""

    def receive(self, data: bytes, t_ns: int) -> bytes:
        """The answers to whatever `data` completes; with faults, not always what was meant."""
        answer = b"".join(self._take(byte, t_ns) for byte in data)
        return self._spoilt(answer) if answer else b""

    def power_on(self) -> bytes:
        """What a robot says when it starts."""
        return GREETING

    def _take(self, byte: int, t_ns: int) -> bytes:
        if not self._mode:
            self._mode = "binary" if byte > 127 else "text" if byte else ""
        if self._mode == "text":
            return self._take_text(byte, t_ns)
        return self._take_binary(byte, t_ns) if self._mode else b""

    def _take_text(self, byte: int, t_ns: int) -> bytes:
        """Line ends before a command are skipped; what follows one is text, whatever it was meant to be."""
        if byte not in _LINE_ENDS:
            self._waiting.append(byte)
            return b""
        if not self._waiting:
            return b""
        line, self._waiting, self._mode = bytes(self._waiting), bytearray(), ""
        return self._text_answer(line, t_ns)

    def _take_binary(self, byte: int, t_ns: int) -> bytes:
        """Collect a batch; nothing is done before its end, and nothing times out."""
        self._waiting.append(byte)
        if not _is_complete(self._waiting):
            return b""
        batch, self._waiting, self._mode = bytes(self._waiting), bytearray(), ""
        return self._batch_answer(batch, t_ns)

    def _batch_answer(self, batch: bytes, t_ns: int) -> bytes:
        answer, at = b"", 0
        while batch[at]:
            command = chr(256 - batch[at])
            count = _ARGUMENTS.get(command, 0)
            answer += self._binary(command, batch[at + 1 : at + 1 + count], t_ns)
            at += 1 + count
        return answer

    def _binary(self, command: str, arguments: bytes, t_ns: int) -> bytes:
        robot = self._robot
        if command == "D":
            left, right = struct.unpack("<hh", arguments)
            robot.drive(left, right, t_ns)
        elif command == "P":
            left, right = struct.unpack("<hh", arguments)
            robot.set_counters(left, right, t_ns)
        elif command == "L":
            self._light(*arguments)
        elif command == "\x09" and self._model == "epuck2":
            self._actuators(arguments, t_ns)
        else:
            return self._sensors(command, t_ns)
        return b""

    def _sensors(self, command: str, t_ns: int) -> bytes:
        robot = self._robot
        answers: dict[str, Callable[[], bytes]] = {
            "Q": lambda: struct.pack("<HH", *robot.counters(t_ns)),
            "E": lambda: struct.pack("<hh", *robot.commanded),
            "N": lambda: struct.pack("<8H", *robot.proximity(t_ns)),
            "O": lambda: struct.pack("<8H", *robot.ambient()),
            "a": lambda: struct.pack("<3h", 0, 0, 800),
            "A": lambda: struct.pack("<3f", 800.0, 0.0, 0.0),
            "g": lambda: bytes(6),
            "u": lambda: bytes(6),
            "b": lambda: struct.pack("<H", self._battery(t_ns)),
            "M": lambda: bytes(10 if self._model == "epuck1" else 8),
            "I": self._image,
        }
        if command == "\x08" and self._model == "epuck2":
            return sensor_block(robot, t_ns)
        return answers[command]() if command in answers else b""

    def _battery(self, t_ns: int) -> int:
        """The e-puck1 (before hardware 1.3) only says whether it is low: 3.4 V."""
        volts = self._robot.battery_v(t_ns)
        return battery_raw(volts) if self._model == "epuck2" else int(volts > 3.4)

    def _image(self) -> bytes:
        """Three header bytes, then the pixels, high byte first: a grey ramp."""
        side = IMAGE_SIDE
        ramp = np.arange(side * side, dtype=">u2")
        return bytes((1, side, side)) + ramp.tobytes()

    def _actuators(self, arguments: bytes, t_ns: int) -> None:
        flags, left, right = struct.unpack_from("<Bhh", arguments)
        if flags & 4:
            self._robot.set_counters(left, right, t_ns)
        else:
            self._robot.drive(left, right, t_ns)

    def _light(self, number: int, action: int) -> None:
        """Action 0 off, 1 on, 2 turn over; 8 is the body's light and 9 the front's."""
        bit = 1 << number
        lights = self._robot.lights
        self._robot.lights = {0: lights & ~bit, 1: lights | bit}.get(action, lights ^ bit) & 0x3FF

    def _text_answer(self, line: bytes, t_ns: int) -> bytes:
        """The first command after power-on often gets no answer."""
        if self._silent_once:
            self._silent_once = False
            return b""
        text = line.decode("latin-1")
        command = text[0] if text[0] in "bg" else text[0].upper()
        numbers = [int(part) for part in text.split(",")[1:] if part.strip("- ").isdigit()]
        return self._text(command, numbers, t_ns)

    def _text(self, command: str, numbers: list[int], t_ns: int) -> bytes:
        robot = self._robot
        if command == "V":
            return self._version
        if command == "R":
            return self._reset(t_ns)
        if command == "S" or (command == "D" and len(numbers) == 2):
            left, right = numbers if command == "D" else (0, 0)
            robot.drive(left, right, t_ns)
            return command.lower().encode() + b"\r\n"
        if command == "P" and len(numbers) == 2:
            robot.set_counters(numbers[0], numbers[1], t_ns)
            return b"p\r\n"
        readings = {"E": robot.commanded, "C": (robot.selector,)}
        if command in "QNO":
            counts = robot.counts(t_ns) if self._model == "epuck2" else robot.counters(t_ns)
            readings |= {"Q": counts, "N": robot.proximity(t_ns), "O": robot.ambient()}
        if command in readings:
            return ",".join([command.lower(), *map(str, readings[command])]).encode() + b"\r\n"
        return b"z,Command not found\r\n"

    def _reset(self, t_ns: int) -> bytes:
        """The e-puck1 starts anew and greets; the e-puck2's firmware does nothing, silently."""
        if self._model == "epuck2" or self._robot.faults.ignores_reset:
            return b""
        self._robot.reset(t_ns)
        return b"r\r\n" + GREETING

    def _spoilt(self, answer: bytes) -> bytes:
        faults, rng = self._robot.faults, self._rng
        middle = len(answer) // 2
        answer, self._late = self._late + answer, b""
        if faults.banner and rng.random() < faults.banner:
            return answer[:middle] + GREETING + answer[middle:]
        if faults.pieces and rng.random() < faults.pieces:
            answer, self._late = answer[:middle], answer[middle:]
        return answer


def _is_complete(batch: bytearray) -> bool:
    """Whether a batch has ended: a zero stands where a command is expected."""
    at = 0
    while at < len(batch) and batch[at]:
        at += 1 + _ARGUMENTS.get(chr(256 - batch[at]), 0)
    return at < len(batch)
