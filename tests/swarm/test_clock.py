"""Clocks: ticks at multiples of the period, scaled, and late ones left out."""

from __future__ import annotations

from itertools import islice

from swarm.clock import NS_PER_S, WallClock


class World:
    """Time that passes only when somebody sleeps or works."""

    def __init__(self) -> None:
        self.now_ns = 5 * NS_PER_S
        self.slept_s: list[float] = []
        self.oversleeps_s = 0.0

    def pass_s(self, seconds: float) -> None:
        self.slept_s.append(seconds)
        self.now_ns += round((seconds + self.oversleeps_s) * NS_PER_S)


def clock_in(world: World, speed: float = 1.0, origin_ns: int = 0) -> WallClock:
    return WallClock(origin_ns, world.now_ns, speed, lambda: world.now_ns, world.pass_s)


def test_ticks_come_at_multiples_of_the_period() -> None:
    world = World()
    clock = clock_in(world, origin_ns=int(0.25 * NS_PER_S))
    ticks = list(islice(clock.ticks(0.1), 4))
    assert ticks == [300_000_000, 400_000_000, 500_000_000, 600_000_000]
    assert [round(seconds, 9) for seconds in world.slept_s] == [0.05, 0.1, 0.1, 0.1]


def test_a_scaled_clock_sleeps_less() -> None:
    world = World()
    ticks = list(islice(clock_in(world, speed=20.0).ticks(0.1), 3))
    assert ticks == [100_000_000, 200_000_000, 300_000_000]
    assert [round(seconds, 9) for seconds in world.slept_s] == [0.005] * 3


def test_late_ticks_are_left_out_and_counted() -> None:
    world = World()
    clock = clock_in(world)
    ticks = clock.ticks(0.1)
    assert next(ticks) == 100_000_000
    world.pass_s(0.35)
    assert next(ticks) == 500_000_000
    assert clock.late_ticks == 3


def test_a_process_that_was_stopped_in_its_sleep_goes_on_from_now() -> None:
    world = World()
    clock = clock_in(world)
    ticks = clock.ticks(0.1)
    assert next(ticks) == 100_000_000
    world.oversleeps_s = 2.05
    assert next(ticks) == 2_200_000_000
    world.oversleeps_s = 0.0
    assert next(ticks) == 2_300_000_000
    assert clock.late_ticks == 20


def test_work_within_the_period_does_not_shift_the_ticks() -> None:
    world = World()
    clock = clock_in(world)
    seen = []
    for t_ns in islice(clock.ticks(0.1), 5):
        seen.append(t_ns)
        world.pass_s(0.06)
    assert seen == [100_000_000 * number for number in range(1, 6)]
    assert clock.late_ticks == 0
