"""The agent's side of a real e-puck: a body whose link a watchdog owns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from robot_agent.drivers.deadline import COMMAND_HOLDS_S
from robot_agent.drivers.health import BodyHealth
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds, WheelSteps
from robot_agent.drivers.motors import EPUCK1
from robot_agent.drivers.notices import Notices, Say
from robot_agent.drivers.robot_link import Reading
from robot_agent.drivers.step_gate import StepGate
from robot_agent.drivers.watchdog_messages import Answer, Event, Identity, Picture, Request, Said, unpacked
from robot_agent.vision.frames import Frame
from swarm.errors import UserError

ANSWER_WITHIN_S = 0.05
"""Half a control period: an agent whose robot does not answer goes on with the counts that it had."""
FIRST_ANSWER_WITHIN_S = 10.0
"""A Bluetooth connection takes some seconds."""


class WatchdogEndedError(Exception):
    """The watchdog's process is gone."""


class Channel(Protocol):
    """The way to a watchdog."""

    def send(self, message: bytes) -> None:
        """Never waits."""

    def receive(self, within_s: float) -> bytes | None:
        """The next message, None if none comes. Raises WatchdogEndedError."""

    def restart(self) -> None:
        """A new watchdog in place of one that has ended: the first thing it does is to stop the robot."""

    def close(self) -> None:
        """Let the watchdog stop the robot and end."""


class EpuckBody:
    """Wheels, lights and sensors of an e-puck over any of its links.

    A command holds for 0.22 s from the reading that it rests on (`wheel_steps`), by the watchdog's clock: one
    that comes late, or out of an agent that was stopped in between, is refused.
    """

    def __init__(
        self, channel: Channel, geometry: EpuckGeometry, now_ns: Callable[[], int], speed: float, say: Say
    ) -> None:
        self._channel = channel
        self._geometry = geometry
        self._now_ns = now_ns
        self._speed = speed
        self._say = say
        self._notices = Notices(say)
        self._gate = StepGate()
        self._motors = EPUCK1
        self._number = 0
        self._observed_ns = 0
        self._lights = 0
        self._commands = (0, 0)
        self._identity = ""
        self._last_event = "nothing was heard of it"
        self._answer: Answer | None = None
        self._reading: Reading | None = None
        self._picture: Picture | None = None
        self._reading_ns = 0
        self._closed = False

    def wait_for_robot(self, within_s: float = FIRST_ANSWER_WITHIN_S) -> str:
        """The robot's identity, once it answers. UserError if it does not."""
        until_ns = self._now_ns() + round(within_s * self._speed * 1e9)
        while not (self._identity and self._reading):
            if self._now_ns() > until_ns:
                raise UserError(f"the robot does not answer: {self._last_event}")
            self._ask()
        return self._identity

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:  # noqa: ARG002
        self._commands = self._motors.sendable(speeds, self._geometry.max_steps_per_s)
        self._send(drives=True)
        return self._motors.running(self._commands)

    def wheel_steps(self, t_ns: int) -> WheelSteps:  # noqa: ARG002
        self._observed_ns = self._now_ns()
        self._ask()
        return self._gate.steps

    def show(self, lights: int) -> None:
        """Switch lights, with the next command: bits 0 to 7 the ring, 8 the body, 9 the front."""
        self._lights = lights

    @property
    def health(self) -> BodyHealth:
        """The newest of what the robot says beside its steps, and how its link does."""
        reading = self._reading or Reading(0, 0)
        answer = self._answer
        return BodyHealth(
            reading.battery_v,
            reading.proximity,
            (self._now_ns() - self._reading_ns) * 1e-9,
            answer.failures if answer else 0,
            self._gate.refused,
            answer.refused if answer else 0,
        )

    @property
    def selector(self) -> int:
        """The position of the robot's selector; -1 if it does not say."""
        return self._reading.selector if self._reading else -1

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self.drive(STOPPED, 0)
            self._channel.close()

    def take_picture(self) -> Frame | None:
        """A new image of the camera on the link, and ask for the next; only while the robot stands."""
        if not any(self._commands):
            self._send(drives=False, image=True)
        picture, self._picture = self._picture, None
        if picture is None:
            return None
        t_ns = round(picture.t_ns / self._speed)
        return Frame(t_ns, picture.width, picture.height, "rgb565", picture.data)

    def _send(self, *, drives: bool, image: bool = False) -> None:
        self._number += 1
        deadline_ns = self._observed_ns + round(COMMAND_HOLDS_S * 1e9)
        left, right = self._commands
        self._channel.send(
            Request(self._number, drives, left, right, self._lights, deadline_ns, image).pack()
        )

    def _ask(self) -> None:
        """Take in what the watchdog says, up to its answer to this question."""
        self._send(drives=False)
        within_s = ANSWER_WITHIN_S / self._speed
        try:
            while message := self._channel.receive(within_s):
                heard = unpacked(message)
                self._take_in(heard)
                if isinstance(heard, Answer) and heard.number == self._number:
                    return
        except WatchdogEndedError:
            self._say("watchdog", "the watchdog has ended; a new one stops the robot and goes on")
            self._channel.restart()

    def _take_in(self, heard: Said) -> None:
        if isinstance(heard, Picture):
            self._picture = heard
        elif isinstance(heard, Event):
            self._last_event = heard.text
            if self._identity:
                self._say("link", heard.text)
        elif isinstance(heard, Identity):
            self._motors = heard.motors
            if heard.text != self._identity:
                self._identity = heard.text
                self._say("robot", heard.text)
        else:
            self._answer = heard
            reading = heard.reading
            if reading and self._gate.take(reading.left, reading.right, heard.t_ns):
                self._reading, self._reading_ns = reading, heard.t_ns
                commanded = any(self._commands)
                self._notices.look(reading, self._gate.steps, heard.t_ns, is_commanded=commanded)
