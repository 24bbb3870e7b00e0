"""e-puck1 and e-puck2 over a serial line, USB or Bluetooth: binary batches of "advanced sercom".

Sources: e-puck-library, Asercom.c (1.2.2); e-puck2_main-processor, Asercom2.c (2.0). Needs pyserial (the
`serial` extra) for /dev/... ports; a Bluetooth address needs Python's own sockets alone.
"""

from __future__ import annotations

import re
import socket
import struct

from robot_agent.drivers.byte_line import ByteLine, Port
from robot_agent.drivers.motors import EPUCK1, EPUCK2
from robot_agent.drivers.robot_link import Actuators, LinkError, Reading, ReplyError, require_agreement

BAUD = 115_200
RFCOMM_CHANNELS = (2, 1)
"""The e-puck2 listens on 2 (its 1 is a debugger), the e-puck1 on 1 alone."""
REPLY_WITHIN_S = 0.1
"""An answer takes 3 ms on a wire and 20 to 60 ms over Bluetooth."""
QUIET_S = 0.02
IMAGE_SIDE = 40
IMAGE_HEADER = bytes((1, IMAGE_SIDE, IMAGE_SIDE))
"""Mode 1 is RGB565; then width and height."""
IMAGE_WITHIN_S = 0.6
"""Twice as long as 3203 bytes take at 115,200 baud."""
VERSION_WITHIN_S = 0.3
VERSION_ATTEMPTS = 5
"""The first `V` may stay without an answer."""
SILENT_BEFORE_RESYNCHRONISING = 2
LONGEST_BATCH = 24
"""So many zeros end whatever batch the firmware was in the middle of: it never times out."""
MOST_STEPS_BETWEEN = 8
"""The two readings of the counters in one batch lie less than 3 ms apart."""
BATTERY_COUNTS_PER_V = 819.2
"""e-puck2, battery_level.h: 12 bits of 3 V behind a divider of 330 / 550."""
LEAST_BATTERY_COUNTS = 1000
"""An e-puck1 before hardware 1.3 only says 0 or 1."""

_BLUETOOTH = re.compile(r"(?:[0-9A-Fa-f]{2}:){5}[0-9A-Fa-f]{2}")
_REPLY = struct.Struct("<HH8HHHH")
_LIGHTS = 10


def _code(letter: str) -> int:
    """A binary command is its letter's negative."""
    return 256 - ord(letter)


def command_batch(actuators: Actuators, lights_before: int) -> bytes:
    """Speeds and changed lights, then what is read: the counters first and last, so that a torn or
    shifted answer shows."""
    batch = struct.pack("<Bhh", _code("D"), actuators.left, actuators.right)
    for light in range(_LIGHTS):
        if (actuators.lights ^ lights_before) >> light & 1:
            batch += bytes((_code("L"), light, actuators.lights >> light & 1))
    return batch + bytes((_code("Q"), _code("N"), _code("b"), _code("Q"), 0))


def parsed_reply(reply: bytes) -> Reading:
    """The reading in the answer to a batch. ReplyError if it is none."""
    if len(reply) < _REPLY.size:
        raise ReplyError(f"{len(reply)} bytes of {_REPLY.size} came")
    left, right, *echoes, battery, left_after, right_after = _REPLY.unpack(reply[-_REPLY.size :])
    volts = battery / BATTERY_COUNTS_PER_V if battery >= LEAST_BATTERY_COUNTS else 0.0
    reading = Reading(left_after, right_after, tuple(echoes), volts).checked()
    require_agreement(Reading(left, right), reading, MOST_STEPS_BETWEEN)
    return reading


class SerialLink:
    """An e-puck at the other end of a line of bytes."""

    def __init__(
        self, line: ByteLine, reply_within_s: float = REPLY_WITHIN_S, quiet_s: float = QUIET_S
    ) -> None:
        self._line = line
        self._reply_within_s = reply_within_s
        self._quiet_s = quiet_s
        self._lights = 0
        self._silent = 0
        self.resynchronise()
        self.identity = self._version()
        self.motors = EPUCK2 if "Version 2" in self.identity else EPUCK1
        self._selector = self._asked_selector()

    def exchange(self, actuators: Actuators) -> Reading:
        if self._silent >= SILENT_BEFORE_RESYNCHRONISING:
            self.resynchronise()
        # An answer that came too late for the last exchange would else be taken for this one's, for ever.
        self._line.receive(0.0)
        self._line.send(command_batch(actuators, self._lights))
        reply = self._line.receive_until(lambda data: len(data) >= _REPLY.size, self._reply_within_s)
        self._silent = 0 if reply else self._silent + 1
        try:
            reading = parsed_reply(reply)
        except ReplyError:
            self._line.drain(self._quiet_s)
            raise
        self._lights = actuators.lights
        return Reading(reading.left, reading.right, reading.proximity, reading.battery_v, self._selector)

    def picture(self) -> tuple[int, int, bytes] | None:
        """The firmware's own choice of 40 x 40 pixels; it takes 0.3 s on the line."""
        self._line.receive(0.0)
        self._line.send(bytes((_code("I"), 0)))
        expected = len(IMAGE_HEADER) + 2 * IMAGE_SIDE * IMAGE_SIDE
        image = self._line.receive_until(lambda data: len(data) >= expected, IMAGE_WITHIN_S)
        if len(image) != expected or image[: len(IMAGE_HEADER)] != IMAGE_HEADER:
            self._line.drain(self._quiet_s)
            return None
        return IMAGE_SIDE, IMAGE_SIDE, image[len(IMAGE_HEADER) :]

    def resynchronise(self) -> None:
        """Bring the firmware back to where it expects a command, whatever it was in; the wheels stop.

        A text command ends in one CR alone: the LF of a CR LF would swallow the next batch.
        """
        self._line.send(bytes(LONGEST_BATCH) + struct.pack("<BhhB", _code("D"), 0, 0, 0))
        self._line.drain(self._quiet_s)
        self._line.send(b"\r")
        self._line.drain(self._quiet_s)
        self._silent = 0
        self._lights = 0

    def _version(self) -> str:
        for _ in range(VERSION_ATTEMPTS):
            self._line.send(b"V\r")
            answer = self._line.receive_until(
                lambda data: b"v," in data and b"\r\n" in data, VERSION_WITHIN_S
            )
            answer += self._line.drain(self._quiet_s)
            if found := re.search(rb"v,([ -~]+)", answer):
                return found[1].decode("ascii")
        raise LinkError("the robot does not tell its version: is its selector at 3 (Bluetooth) or 8 (USB)?")

    def _asked_selector(self) -> int:
        """-1 if the robot does not say."""
        self._line.send(b"C\r")
        answer = self._line.receive_until(lambda data: data.endswith(b"\r\n"), VERSION_WITHIN_S)
        found = re.search(rb"c,(\d{1,2})\r", answer)
        return int(found[1]) if found else -1

    def close(self) -> None:
        self._line.close()


def open_link(address: str) -> SerialLink:
    """The robot at a port such as /dev/ttyACM0 or a Bluetooth address. LinkError if it cannot be reached."""
    line = ByteLine(_bluetooth(address) if _BLUETOOTH.fullmatch(address) else _port(address))
    try:
        return SerialLink(line)
    except BaseException:
        line.close()
        raise


def _port(address: str) -> Port:
    import serial

    try:
        port: Port = serial.Serial(address, BAUD, timeout=0, exclusive=True)
    except (OSError, ValueError) as error:
        raise LinkError(f"cannot open {address}: {error}") from error
    return port


def _bluetooth(address: str) -> Port:
    """The first channel that answers."""
    reason = "Python was built without Bluetooth"
    for channel in RFCOMM_CHANNELS if hasattr(socket, "AF_BLUETOOTH") else ():
        try:
            return _connected(address, channel)
        except OSError as error:
            reason = f"channel {channel}: {error}"
    raise LinkError(f"cannot reach {address}: {reason}; is the robot paired, is its selector at 3?")


def _connected(address: str, channel: int) -> socket.socket:
    port = socket.socket(socket.AF_BLUETOOTH, socket.SOCK_STREAM, socket.BTPROTO_RFCOMM)
    try:
        port.connect((address, channel))
    except OSError:
        port.close()
        raise
    return port
