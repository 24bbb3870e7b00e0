"""The e-puck2's block of all sensors: 103 bytes over the serial line, one more over Wi-Fi."""

from __future__ import annotations

import struct

from robot_agent.emulator.robot import EmulatedRobot

BLOCK_BYTES = 103
BATTERY_COUNTS_PER_V = 4096 * 0.6 / 3.0
"""battery_level.h: 12 bits of 3 V behind a divider of 330 / (220 + 330)."""
TEMPERATURE_C = 25
NOTHING_NEAR_MM = 2000
"""What the distance sensor shows when nothing is near."""


def battery_raw(volts: float) -> int:
    """What the battery's converter shows."""
    return round(volts * BATTERY_COUNTS_PER_V)


def sensor_block(robot: EmulatedRobot, t_ns: int) -> bytes:
    """Everything that the robot measures, in the order of the firmware (all little-endian)."""
    block = bytearray(BLOCK_BYTES)
    struct.pack_into("<3h", block, 0, 0, 0, 800)
    struct.pack_into("<3f", block, 6, 800.0, 0.0, 0.0)
    struct.pack_into("<b", block, 36, TEMPERATURE_C)
    struct.pack_into("<8H", block, 37, *robot.proximity(t_ns))
    struct.pack_into("<8H", block, 53, *robot.ambient())
    struct.pack_into("<H", block, 69, NOTHING_NEAR_MM)
    struct.pack_into("<HH", block, 79, *robot.counters(t_ns))
    struct.pack_into("<H", block, 83, battery_raw(robot.battery_v(t_ns)))
    block[89] = robot.selector
    return bytes(block)
