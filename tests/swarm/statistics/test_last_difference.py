"""From when and until when curves differ, and how sure that is."""

from __future__ import annotations

import numpy as np

from swarm.statistics.last_difference import first_difference, joining, last_difference
from swarm.statistics.samples import Curves

TIMES = np.arange(1.0, 41)


def curves(difference: np.ndarray, pairs: int, seed: int) -> Curves:
    noise = np.random.default_rng(seed).normal(size=(pairs, len(TIMES)))
    return Curves("drawn", TIMES, difference + noise, tuple(range(pairs)))


NONE = Curves("none", TIMES, np.zeros((60, 40)), tuple(range(60)))
HUMP = np.where((TIMES >= 11) & (TIMES <= 25), 3.0, 0.0)


def test_a_clear_difference_is_seen_from_its_start_to_its_end() -> None:
    larger = curves(HUMP, 60, 1)
    first, last = (
        search(larger, NONE, np.random.default_rng(2)) for search in (first_difference, last_difference)
    )
    assert first.time == 11
    assert last.time == 25
    assert first.low <= 11 <= first.high
    assert last.low <= 25 <= last.high


def test_only_differences_in_the_direction_asked_for_count() -> None:
    assert last_difference(NONE, curves(HUMP, 60, 1), np.random.default_rng(2)).time is None
    assert joining(NONE, curves(HUMP, 60, 1), np.random.default_rng(2), size=1.0).time == 25


def test_small_differences_do_not_keep_curves_apart() -> None:
    late = HUMP + np.where(TIMES > 30, 0.6, 0.0)
    larger = curves(late, 60, 3)
    assert last_difference(larger, NONE, np.random.default_rng(4)).time == 40
    assert joining(larger, NONE, np.random.default_rng(4), size=1.5).time == 25


def test_another_experiments_time_may_lie_a_little_outside() -> None:
    larger = curves(np.clip(3 - TIMES / 10, 0, None), 60, 5)
    seen = last_difference(larger, NONE, np.random.default_rng(6))
    assert seen.time is not None
    assert seen.low < seen.time < seen.high
    assert seen.agrees_with(seen.high + 0.3 * (seen.high - seen.time), rounded_to=0.0)
    assert not seen.agrees_with(seen.high + 0.6 * (seen.high - seen.time), rounded_to=0.0)
    assert not seen.agrees_with(1.0, rounded_to=0.5)


def test_the_interval_holds_the_time_of_other_samples() -> None:
    slope = np.clip(3 - TIMES / 10, 0, None)
    truth = TIMES[np.flatnonzero(slope * np.sqrt(60) > 1.96)[-1]]
    held = 0
    for sample in range(100):
        seen = last_difference(curves(slope, 60, 10 + sample), NONE, np.random.default_rng(sample))
        held += seen.low - 1 <= truth <= seen.high + 1
    assert held >= 88
