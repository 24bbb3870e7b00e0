"""What a person should be told of a real robot while it runs, once."""

from __future__ import annotations

from collections.abc import Callable

from robot_agent.drivers.kinematics import WheelSteps
from robot_agent.drivers.robot_link import Reading

LOW_BATTERY_V = 3.5
"""An e-puck2 counts 3.4 V as empty (battery_level.h)."""
SETTLES_IN_NS = 1_000_000_000
"""So long after its last command a robot stands, over the slowest link."""
STEPS_BY_ITSELF = 20
"""2.6 mm: more than a wheel that is touched."""

Say = Callable[[str, str], None]
"""Takes the name and the text of an event for the log."""


class Notices:
    """Looks at every good reading: for a low battery, and for wheels that turn though nobody commands."""

    def __init__(self, say: Say) -> None:
        self._say = say
        self._said: set[str] = set()
        self._settled_ns = 0
        self._stood_at: WheelSteps | None = None

    def look(self, reading: Reading, steps: WheelSteps, t_ns: int, *, is_commanded: bool) -> None:
        """A reading, the counts that it stands for, and whether the wheels are to turn."""
        if 0 < reading.battery_v < LOW_BATTERY_V:
            self._say_once("battery", f"{reading.battery_v:.2f} V: charge the robot")
        if is_commanded:
            self._settled_ns = t_ns + SETTLES_IN_NS
        if t_ns < self._settled_ns or self._stood_at is None:
            self._stood_at = steps
        elif _apart(steps, self._stood_at) > STEPS_BY_ITSELF:
            self._say_once("moved", "the wheels turn without a command: a TV remote, or a second program?")

    def _say_once(self, name: str, text: str) -> None:
        if name not in self._said:
            self._said.add(name)
            self._say(name, text)


def _apart(steps: WheelSteps, others: WheelSteps) -> int:
    return max(abs(steps.left - others.left), abs(steps.right - others.right))
