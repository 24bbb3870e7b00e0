"""Bytes on each link, there and back, against those that the protocols' documents give."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from robot_agent.drivers import i2c, serial, spi, wifi
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.motors import EPUCK1, EPUCK2, YORK
from robot_agent.drivers.robot_link import Actuators, LinkError, ReplyError
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.emulator.asercom import GREETING, Asercom
from robot_agent.emulator.esp32 import Esp32
from robot_agent.emulator.faults import Faults
from robot_agent.emulator.i2c_slaves import GumstixSlave, YorkSlave
from robot_agent.emulator.lpuck import LpuckSlave
from robot_agent.emulator.robot import EmulatedRobot
from swarm.clock import NS_PER_S
from tests.support.emulated_robot import HALL, MIDDLE

DRIVE = Actuators(left=500, right=-250)
SPEEDS = bytes.fromhex("f40106ff")
"""500 and -250 as little-endian 16-bit integers."""


def robot(model: str = "epuck2", faults: Faults | None = None, selector: int = 10) -> EmulatedRobot:
    geometry = EpuckGeometry(max_steps_per_s=1200.0)
    body = SimulatedBody(geometry, BodyFaults(0, 0, 0), MIDDLE, HALL, np.random.default_rng(0))
    motors = EPUCK2 if model == "epuck2" else EPUCK1
    return EmulatedRobot(body, motors, HALL, faults or Faults(), selector)


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


def talked_to(model: str = "epuck2") -> Asercom:
    """A serial robot that has got over its first silence."""
    asercom = Asercom(robot(model), model, rng())
    assert asercom.receive(b"V\r", 0) == b"", "the first command stays without an answer"
    return asercom


def test_the_serial_batch_is_the_documents() -> None:
    """-D and its arguments, then -Q, -N, -b, -Q and the zero that ends a batch."""
    assert serial.command_batch(DRIVE, 0) == b"\xbc" + SPEEDS + bytes.fromhex("afb29eaf00")


def test_lights_that_changed_go_into_the_serial_batch() -> None:
    batch = serial.command_batch(Actuators(lights=0b1_0000_0001), lights_before=0b10)
    assert batch[5:-5] == bytes.fromhex("b40001 b40100 b40801")


def test_the_serial_answer_is_the_documents() -> None:
    counters, echoes, battery = struct.pack("<HH", 65_530, 7), struct.pack("<8H", *range(8)), b"\x80\x0d"
    reading = serial.parsed_reply(counters + echoes + battery + counters)
    assert (reading.left, reading.right, reading.proximity) == (65_530, 7, tuple(range(8)))
    assert reading.battery_v == pytest.approx(3456 / 819.2)
    with pytest.raises(ReplyError, match="moved by"):
        serial.parsed_reply(counters + echoes + battery + struct.pack("<HH", 65_530, 263))


def test_serial_text_is_answered_line_by_line() -> None:
    asercom = talked_to()
    assert asercom.receive(b"V\r", 0).startswith(b"v,Version 2.0 ")
    assert asercom.receive(b"D,100,-100\r", 0) == b"d\r\n"
    assert asercom.receive(b"E\r", 0) == b"e,100,-100\r\n"
    assert asercom.receive(b"Q\r", NS_PER_S) == b"q,100,-100\r\n", "as text the counts do not wrap"
    assert asercom.receive(b"X\r", NS_PER_S) == b"z,Command not found\r\n"
    assert asercom.receive(b"R\r", NS_PER_S) == b"", "the e-puck2 passes a reset over in silence"
    assert talked_to("epuck1").receive(b"R\r", 0) == b"r\r\n" + GREETING


def test_a_line_feed_that_is_left_over_swallows_the_next_batch() -> None:
    asercom = talked_to()
    assert asercom.receive(b"V\r\n", 0).startswith(b"v,")
    batch = serial.command_batch(Actuators(), 0)
    assert asercom.receive(batch, 0) == b""
    assert asercom.receive(b"\r", 0) == b"z,Command not found\r\n"
    assert len(asercom.receive(batch, 0)) == 26


def test_serial_images_have_a_header_of_three_bytes() -> None:
    image = talked_to().receive(b"\xb7\x00", 0)
    assert image[:3] == bytes((1, 40, 40))
    assert len(image) == 3 + 2 * 40 * 40


def test_the_e_puck2s_block_of_all_sensors_has_103_bytes() -> None:
    block = talked_to().receive(b"\xf8\x00", 0)
    assert len(block) == 103
    assert block[89] == 10
    assert talked_to("epuck1").receive(b"\xf8\x00", 0) == b""


def test_the_wifi_command_is_the_documents() -> None:
    """0x80, sensors wanted, settings 0, speeds, LEDs, four colours, sound off."""
    command = wifi.command_bytes(Actuators(500, -250, lights=0b11_0000_0110))
    colours = bytes((50, 0, 0)) + bytes(9)
    assert command == b"\x80\x02\x00" + SPEEDS + b"\x32" + colours + b"\x20"
    assert len(command) == 21


def test_the_wifi_stream_is_cut_by_exact_length() -> None:
    firmware = Esp32(robot(selector=15), rng())
    firmware.connected()
    assert firmware.stream(0) == b"", "nothing comes before the first command"
    firmware.receive(wifi.command_bytes(DRIVE, image=True), 0)
    sent = firmware.stream(0) + b"\x03" + firmware.stream(NS_PER_S)
    assert len(sent) == 2 * (1 + 38_400 + 1 + 104) + 1
    stream, blocks = wifi.Stream(), []
    for start in range(0, len(sent), 1000):
        blocks += stream.take(sent[start : start + 1000])
    readings = [wifi.parsed_sensors(block) for block in blocks]
    assert [(reading.left, reading.right) for reading in readings] == [(0, 0), (500, 65_536 - 250)]
    assert readings[0].selector == 15
    assert len(stream.image) == 38_400
    with pytest.raises(LinkError, match="header byte"):
        stream.take(b"\x55")


def test_the_i2c_block_is_the_documents() -> None:
    command = i2c.command_bytes(DRIVE)
    assert len(command) == 20
    assert command[:19] == SPEEDS + bytes(15)
    assert command[19] == 0xF4 ^ 0x01 ^ 0x06 ^ 0xFF
    slave = GumstixSlave(robot(), rng())
    first = slave.transfer(0x1F, command, 47, 0)
    assert first == bytes(47), "zeros, whose checksum is right"
    with pytest.raises(ReplyError, match="selector"):
        i2c.parsed_reply(first, 0.0)
    reply = slave.transfer(0x1F, command, 47, NS_PER_S)
    assert reply[40] & 0x0F == 10
    reading = i2c.parsed_reply(reply, 4.0)
    assert (reading.left, reading.right, reading.battery_v) == (500, 65_536 - 250, 4.0)
    with pytest.raises(ReplyError, match="checksum"):
        i2c.parsed_reply(bytes((reply[0] ^ 1,)) + reply[1:], 4.0)


def test_a_block_with_a_wrong_checksum_is_answered_but_not_obeyed() -> None:
    emulated = robot()
    slave = GumstixSlave(emulated, rng())
    reply = slave.transfer(0x1F, i2c.command_bytes(DRIVE)[:-1] + b"\x00", 47, 0)
    assert len(reply) == 47
    assert emulated.commanded == (0, 0)


def test_yorks_registers_are_the_documents() -> None:
    emulated = robot("epuck1")
    slave = YorkSlave(emulated, rng())
    slave.transfer(0x1F, b"\x02" + SPEEDS[:2], 0, 0)
    slave.transfer(0x1F, b"\x03" + SPEEDS[2:], 0, 0)
    assert emulated.commanded == (500, -250)
    assert slave.transfer(0x1F, b"\x04", 2, NS_PER_S) == struct.pack("<H", 500)
    assert slave.transfer(0x1F, b"\x07", 2, NS_PER_S) == b"\x00\x00", "infra-red is off at first"
    slave.transfer(0x1F, b"\x06\x01", 0, NS_PER_S)
    assert slave.transfer(0x1F, b"\x07", 2, NS_PER_S) == struct.pack("<h", 67)
    with pytest.raises(OSError, match="Remote I/O"):
        slave.transfer(0x20, b"\x04", 2, NS_PER_S)


def test_the_spi_words_are_the_documents() -> None:
    command = spi.command_bytes(Actuators(500, -250, lights=0b11))
    assert len(command) == 50
    assert command == struct.pack("<4h", 0b100011, 500, -250, 3) + bytes(42)
    emulated = robot("epuck1")
    slave = LpuckSlave(emulated, rng())
    slave.transfer(command, 0)
    reply = slave.transfer(command, NS_PER_S)
    words = struct.unpack("<25H", reply)
    assert words[:8] == (67,) * 8
    assert words[22:24] == (500, 65_536 - 250)
    assert spi.parsed_reply(reply).left == 500
    assert emulated.lights == 3


def test_a_bluetooth_robot_that_is_not_there_is_named_with_its_cure() -> None:
    with pytest.raises(LinkError, match=r"cannot reach 10:00:E8:AD:12:34: .*selector at 3"):
        serial.open_link("10:00:E8:AD:12:34")


def test_motors_run_at_the_speeds_that_the_documents_list() -> None:
    above_500 = sorted({round(EPUCK1.run_at(command)) for command in range(501, 1001)})
    assert above_500 == [526, 556, 588, 625, 667, 714, 769, 833, 909, 1000]
    assert EPUCK1.run_at(910) == 1000
    assert EPUCK2.run_at(1100) == pytest.approx(1111, abs=0.2)
    assert EPUCK2.run_at(5000) == EPUCK2.run_at(1100)
    for motors, worst in ((EPUCK2, 0.0222), (YORK, 0.017)):
        errors = [motors.run_at(command) / command - 1 for command in range(1, motors.limit_steps_per_s + 1)]
        assert worst - 0.001 < max(map(abs, errors)) <= worst


@pytest.mark.parametrize("motors", [EPUCK1, EPUCK2, YORK])
@pytest.mark.parametrize("wanted", [3.2, 120.0, -333.0, 545.0, 776.0, -940.0])
def test_the_command_with_the_nearest_real_speed_is_chosen(motors: object, wanted: float) -> None:
    assert isinstance(motors, type(EPUCK1))
    every = range(-motors.limit_steps_per_s, motors.limit_steps_per_s + 1)
    nearest = min(abs(motors.run_at(command) - wanted) for command in every)
    assert abs(motors.run_at(motors.command_for(wanted)) - wanted) == pytest.approx(nearest, abs=0.02)
