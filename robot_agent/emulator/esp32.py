"""The e-puck2's Wi-Fi side: 21 bytes in, images and sensors out, and it never stops sending.

Source: GCtronic's ESP32 firmware, socket_e-puck2.c. The last command is obeyed again in every cycle; a
lost connection does not stop the wheels.
"""

from __future__ import annotations

import struct

import numpy as np

from robot_agent.emulator.all_sensors import sensor_block
from robot_agent.emulator.robot import EmulatedRobot
from swarm.clock import NS_PER_S

COMMAND_BYTES = 21
COMMAND_START = 0x80
IMAGE_WIDTH, IMAGE_HEIGHT = 160, 120
UNREAD_COMMANDS = 5
"""Of more that wait unread, the oldest are dropped."""
SENSORS_EVERY_NS = NS_PER_S // 50
"""A cycle without an image takes about 20 ms."""
IMAGE_EVERY_NS = 140 * NS_PER_S // 1000
"""And 133 to 142 ms with one, the median of others' measurements."""


class Esp32:
    """One connection at a time; what it sends depends on the clock and the last command."""

    def __init__(
        self, robot: EmulatedRobot, rng: np.random.Generator, cycle_ns: int = SENSORS_EVERY_NS
    ) -> None:
        self._robot = robot
        self._cycle_ns = cycle_ns
        self._rng = rng
        self._request = 0
        self._asked = False
        self._waiting = b""
        self._due_ns = 0
        self._late = b""
        self._stalled_until_ns = 0
        self._unread = b""

    def connected(self) -> None:
        """A client has come: nothing is sent before its first command."""
        self._asked = False
        self._waiting = self._late = self._unread = b""

    def receive(self, data: bytes, t_ns: int) -> bytes:
        """Take commands in. Only one that comes whole is checked for its first byte."""
        if t_ns < self._stalled_until_ns:
            self._unread = (self._unread + data)[-UNREAD_COMMANDS * COMMAND_BYTES :]
            return b""
        data, self._unread = self._unread + data, b""
        if not self._waiting and len(data) >= COMMAND_BYTES and data[0] != COMMAND_START:
            return b""
        self._waiting += data
        while len(self._waiting) >= COMMAND_BYTES:
            command, self._waiting = self._waiting[:COMMAND_BYTES], self._waiting[COMMAND_BYTES:]
            self._obey(command, t_ns)
        return b""

    def stream(self, t_ns: int) -> bytes:
        """What is due to be sent now."""
        if not self._asked or t_ns < self._due_ns:
            return b""
        if t_ns < self._stalled_until_ns:
            return b""
        if self._unread:
            self.receive(b"", t_ns)
        faults, rng = self._robot.faults, self._rng
        self._due_ns = t_ns + (IMAGE_EVERY_NS if self._request & 1 else self._cycle_ns)
        if faults.stall and rng.random() < faults.stall:
            self._stalled_until_ns = t_ns + round(faults.stall_s * NS_PER_S)
            return b""
        answer, self._late = self._late + self._reply(t_ns), b""
        if faults.pieces and rng.random() < faults.pieces:
            middle = len(answer) // 2
            answer, self._late = answer[:middle], answer[middle:]
        return answer

    def _obey(self, command: bytes, t_ns: int) -> None:
        if not self._asked:
            self._due_ns = t_ns
        self._asked = True
        _, self._request, settings, left, right, lights = struct.unpack_from("<BBBhhB", command)
        if settings & 4:
            self._robot.set_counters(left, right, t_ns)
        else:
            self._robot.drive(left, right, t_ns)
        ring = sum(1 << 2 * number for number in range(4) if lights >> number & 1)
        colours = sum(1 << 2 * n + 1 for n in range(4) if any(command[8 + 3 * n : 11 + 3 * n]))
        self._robot.lights = ring | colours | (lights & 0x30) << 4

    def _reply(self, t_ns: int) -> bytes:
        reply = b""
        if self._request & 1:
            rows = np.arange(IMAGE_HEIGHT * IMAGE_WIDTH, dtype=np.uint32).astype(">u2")
            reply += b"\x01" + rows.tobytes()
        if self._request & 2:
            reply += b"\x02" + sensor_block(self._robot, t_ns) + b"\x00"
        return reply or b"\x03"
