"""The e-puck under the paper's own Linux board: 25 words each way in one SPI transfer.

Source: W. Liu's Player driver for the board of Liu and Winfield (2011).
"""

from __future__ import annotations

import errno
import struct

import numpy as np

from robot_agent.emulator.all_sensors import battery_raw
from robot_agent.emulator.robot import EmulatedRobot

WORDS = 25
SET_MOTORS, SET_LIGHTS, RESET = 1, 2, 4


class LpuckSlave:
    """Answers a transfer with what it measured; commands without their bit are passed over."""

    def __init__(self, robot: EmulatedRobot, rng: np.random.Generator) -> None:
        self._robot = robot
        self._rng = rng

    def transfer(self, sent: bytes, t_ns: int) -> bytes:
        """50 bytes for 50 bytes. OSError if the transfer fails."""
        robot = self._robot
        if robot.faults.failure and self._rng.random() < robot.faults.failure:
            raise OSError(errno.EIO, "SPI transfer failed")
        commands, left, right, lights = struct.unpack_from("<4h", sent)
        if commands & SET_MOTORS:
            robot.drive(left, right, t_ns)
        if commands & SET_LIGHTS:
            robot.lights = lights & 0x3FF
        if commands & RESET and not robot.faults.ignores_reset:
            robot.reset(t_ns)
        return self._reply(t_ns)

    def _reply(self, t_ns: int) -> bytes:
        robot = self._robot
        infra_red, ambient = robot.proximity(t_ns), robot.ambient()
        words = (*infra_red, 0, 0, 800, 0, 0, 0, *ambient, *robot.counters(t_ns))
        return struct.pack("<25H", *words, battery_raw(robot.battery_v(t_ns)))
