"""Step counters: unwrapped, with readings refused that wheels cannot have made."""

from __future__ import annotations

from robot_agent.drivers.kinematics import WheelSteps
from robot_agent.drivers.step_gate import StepGate

TICK_NS = 100_000_000


def gate_after(*readings: tuple[int, int]) -> StepGate:
    """A gate that took these readings, one a tick."""
    gate = StepGate()
    for tick, (left, right) in enumerate(readings):
        gate.take(left & 0xFFFF, right & 0xFFFF, tick * TICK_NS)
    return gate


def test_counts_go_on_over_the_wrap_both_ways() -> None:
    gate = gate_after((65_500, 50), (65_600, -50), (65_700, -150))
    assert gate.steps == WheelSteps(65_700, -150)
    assert gate.refused == 0


def test_a_reading_that_wheels_cannot_have_made_is_refused() -> None:
    gate = gate_after((1000, 1000), (1100, 30_000), (1200, 1200))
    assert gate.steps == WheelSteps(1200, 1200)
    assert gate.refused == 1


def test_after_a_reset_the_counts_go_on_from_where_they_were() -> None:
    gate = gate_after((30_000, 30_000), (0, 0), (100, 90), (200, 180))
    assert gate.steps == WheelSteps(30_200, 30_180)


def test_a_wrong_reading_that_was_possible_is_made_good() -> None:
    gate = gate_after((1000, 1000), (900, 900), (1100, 1100), (1200, 1200))
    assert gate.steps == WheelSteps(1200, 1200)


def test_after_a_long_silence_the_counts_go_on_as_far_as_the_wheels_can_have_turned() -> None:
    gate = StepGate()
    gate.take(0, 0, 0)
    assert gate.take(10_000, 9_000, 100 * TICK_NS)
    assert gate.steps == WheelSteps(10_000, 9_000)
