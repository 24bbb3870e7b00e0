"""Which speeds an e-puck's stepper motors really run at: its firmware counts whole timer ticks a step."""

from __future__ import annotations

import math
from dataclasses import dataclass

from robot_agent.drivers.kinematics import WheelSpeeds


@dataclass(frozen=True, slots=True)
class StepperMotors:
    """The motors of one firmware. A step takes `timer_hz // |speed|` timer ticks (and `extra_ticks`)."""

    timer_hz: int
    limit_steps_per_s: int
    extra_ticks: int = 0

    def run_at(self, command: int) -> float:
        """The speed (steps/s) at which the firmware runs for a commanded one, which it first clamps."""
        if command == 0:
            return 0.0
        clamped = min(abs(command), self.limit_steps_per_s)
        return math.copysign(self.timer_hz / (self.timer_hz // clamped + self.extra_ticks), command)

    def command_for(self, steps_per_s: float) -> int:
        """The command whose real speed is nearest to a wanted one; the sign is kept."""
        wanted = min(abs(steps_per_s), float(self.limit_steps_per_s))
        if wanted < 0.5:
            return 0
        ticks = math.floor(self.timer_hz / wanted) - self.extra_ticks
        commands = {round(wanted) or 1, self._slowest_with(ticks), self._slowest_with(ticks + 1)}
        nearest = min(sorted(commands), key=lambda command: abs(self.run_at(command) - wanted))
        return int(math.copysign(nearest, steps_per_s))

    def _slowest_with(self, ticks: int) -> int:
        """The smallest command that makes a step take so many timer ticks."""
        return max(1, min(self.timer_hz // (ticks + 1) + 1, self.limit_steps_per_s))

    def sendable(self, speeds: WheelSpeeds, limit_steps_per_s: float) -> tuple[int, int]:
        """The commands for two wheels, slowed by one factor so that the robot keeps to its curve.

        Raises ValueError if a speed is not finite.
        """
        left, right = speeds.left_steps_per_s, speeds.right_steps_per_s
        if not math.isfinite(left) or not math.isfinite(right):
            raise ValueError(f"wheel speeds must be finite, got {left} and {right} steps/s")
        limit = min(limit_steps_per_s, self.limit_steps_per_s)
        factor = min(1.0, limit / max(abs(left), abs(right), 1.0))
        return self.command_for(left * factor), self.command_for(right * factor)

    def running(self, commands: tuple[int, int]) -> WheelSpeeds:
        """The speeds at which both wheels will really run."""
        return WheelSpeeds(self.run_at(commands[0]), self.run_at(commands[1]))


EPUCK1 = StepperMotors(timer_hz=10_000, limit_steps_per_s=1000)
"""e-puck-library, e_motors.c: an agenda of 0.1 ms; above 500 steps/s only 526, 556 ... 909, 1000 exist."""

EPUCK2 = StepperMotors(timer_hz=50_000, limit_steps_per_s=1100)
"""e-puck2_main-processor, motors.c: half steps at 100 kHz; at most 2.2 % off, 1100 runs at 1111."""

YORK = StepperMotors(timer_hz=57_600, limit_steps_per_s=1000, extra_ticks=1)
"""pi-puck-e-puck1, motors.c: 14.7456 MHz / 256, and a dsPIC timer runs for one count more."""
