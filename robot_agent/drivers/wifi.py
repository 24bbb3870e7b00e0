"""An e-puck2 over Wi-Fi: 21 bytes there, 104 bytes of sensors and 38,400 of image back (TCP port 1000).

Source: GCtronic's ESP32 firmware, socket_e-puck2.c and uart_e-puck2.c. The robot sends all the time and
repeats the last command in every cycle; a lost connection does not stop its wheels.
"""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable

from robot_agent.drivers.byte_line import ByteLine
from robot_agent.drivers.motors import EPUCK2
from robot_agent.drivers.robot_link import HIGHEST_RAW, Actuators, LinkError, Reading, ReplyError

PORT = 1000
CONNECT_WITHIN_S = 2.0
REPLY_WITHIN_S = 0.1
"""Sensors come every 20 to 30 ms; the firmware's pauses of 1.5 s are not waited for."""
REPLY_WITH_IMAGE_WITHIN_S = 0.2
"""With images a cycle takes 0.14 s."""
FIRST_REPLY_WITHIN_S = 3.0
IMAGE_WIDTH, IMAGE_HEIGHT = 160, 120
IMAGE, SENSORS, EMPTY = 1, 2, 3
LENGTHS = {IMAGE: 38_400, SENSORS: 104, EMPTY: 0}
"""Bytes after each header byte."""
BATTERY_COUNTS_PER_V = 819.2
"""As over the serial line."""
SOUND_OFF = 0x20
BRIGHT = 50
"""Of 100: bright enough to see, half the current."""
HIGHEST_SELECTOR = 15


def command_bytes(actuators: Actuators, *, image: bool = False) -> bytes:
    """The 21 bytes of a command. Settings stay 0: never the firmware's own obstacle avoidance, which
    would not let the wheels stop."""
    ring = actuators.lights & 0xFF
    leds = sum((ring >> 2 * number & 1) << number for number in range(4)) | actuators.lights >> 4 & 0x30
    colours = b"".join(bytes((BRIGHT * (ring >> 2 * number + 1 & 1), 0, 0)) for number in range(4))
    request = SENSORS | (IMAGE if image else 0)
    head = struct.pack("<BBBhhB", 0x80, request, 0, actuators.left, actuators.right, leds)
    return head + colours + bytes((SOUND_OFF,))


def parsed_sensors(block: bytes) -> Reading:
    """The reading in the 104 bytes of a sensor block. ReplyError if it is none."""
    echoes = struct.unpack_from("<8H", block, 37)
    left, right, battery = struct.unpack_from("<HHH", block, 79)
    selector, card = block[89], block[85]
    if selector > HIGHEST_SELECTOR or card > 1:
        raise ReplyError(f"selector {selector}, memory card {card}")
    light_and_sound = struct.unpack_from("<8H", block, 53) + struct.unpack_from("<4H", block, 71)
    if max(light_and_sound) > HIGHEST_RAW:
        raise ReplyError(f"ambient light and sound {light_and_sound} have more than 12 bits")
    return Reading(left, right, echoes, battery / BATTERY_COUNTS_PER_V, selector).checked()


class Stream:
    """Cuts what the robot sends into sensor blocks and images, by exact length."""

    def __init__(self) -> None:
        self._waiting = b""
        self.image = b""
        """The newest image: RGB565, high byte first."""

    def take(self, data: bytes) -> list[bytes]:
        """The sensor blocks that are complete now. LinkError if the place of the headers is lost."""
        self._waiting += data
        blocks = []
        while self._waiting:
            kind = self._waiting[0]
            if kind not in LENGTHS:
                raise LinkError(f"the robot sent {kind:#04x} where a header byte has to be")
            end = 1 + LENGTHS[kind]
            if len(self._waiting) < end:
                break
            body, self._waiting = self._waiting[1:end], self._waiting[end:]
            if kind == SENSORS:
                blocks.append(body)
            elif kind == IMAGE:
                self.image = body
        return blocks


class WifiLink:
    """An e-puck2 at the other end of a TCP connection."""

    motors = EPUCK2

    def __init__(
        self,
        line: ByteLine,
        reply_within_s: float = REPLY_WITHIN_S,
        monotonic_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._line = line
        self._reply_within_s = reply_within_s
        self._monotonic_s = monotonic_s
        self._stream = Stream()
        self._images = False
        try:
            selector = self._exchange(Actuators(), FIRST_REPLY_WITHIN_S).selector
        except ReplyError as error:
            raise LinkError(f"the robot does not answer ({error}): is its selector at 15?") from error
        self.identity = f"e-puck2 Wi-Fi, selector {selector}"

    def exchange(self, actuators: Actuators) -> Reading:
        within_s = REPLY_WITH_IMAGE_WITHIN_S if self._images else self._reply_within_s
        self._images = self._images and not (actuators.left or actuators.right)
        return self._exchange(actuators, within_s)

    def _exchange(self, actuators: Actuators, within_s: float) -> Reading:
        """What came before the command is old: only its images are of use."""
        self._stream.take(self._line.receive(0.0))
        self._line.send(command_bytes(actuators, image=self._images))
        until_s = self._monotonic_s() + within_s
        while (left_s := until_s - self._monotonic_s()) > 0:
            if blocks := self._stream.take(self._line.receive(left_s)):
                return parsed_sensors(blocks[-1])
        raise ReplyError(f"no sensors within {within_s:g} s")

    def picture(self) -> tuple[int, int, bytes] | None:
        """The newest image of the stream, which the robot sends from the first call on."""
        self._images = True
        image, self._stream.image = self._stream.image, b""
        return (IMAGE_WIDTH, IMAGE_HEIGHT, image) if image else None

    def close(self) -> None:
        self._line.close()


def open_link(address: str) -> WifiLink:
    """The robot at HOST or HOST:PORT. LinkError if it cannot be reached."""
    host, _, port = address.partition(":")
    try:
        connection = socket.create_connection((host, int(port or PORT)), CONNECT_WITHIN_S)
    except (OSError, ValueError) as error:
        raise LinkError(f"cannot connect to {address}: {error}") from error
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    line = ByteLine(connection)
    try:
        return WifiLink(line)
    except BaseException:
        line.close()
        raise
