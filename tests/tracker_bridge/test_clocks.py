"""From the machine's and the tracking system's clocks to the run's."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tracker_bridge.backends.clocks import ReceiptClock, SourceClock


def test_a_source_clock_gives_times_the_sources_pace() -> None:
    """Packets are late by 2 ms and more; sent 5 ms after exposure; the clocks drift by 50 ppm."""
    clock, rng = SourceClock(), np.random.default_rng(3)
    period_ns, captured = 10_000_000, []
    for number, late_ns in enumerate(rng.exponential(2e6, 3_000).tolist()):
        source_ns = number * period_ns
        received_ns = 10**9 + round(source_ns * (1 + 50e-6)) + 5_000_000 + 2_000_000 + round(late_ns)
        captured.append(clock.captured_ns(source_ns, source_ns + 5_000_000, received_ns))
        assert captured[-1] <= received_ns - 5_000_000
    gaps_ns = np.array([later - earlier for earlier, later in pairwise(captured[200:])])
    assert np.all(gaps_ns > 0)
    assert np.quantile(np.abs(gaps_ns - period_ns), 0.99) < 600_000
    true_ns = 10**9 + 2_999 * period_ns * (1 + 50e-6) + 2_000_000
    assert captured[-1] == pytest.approx(true_ns, abs=1_200_000)


def test_a_server_that_was_started_again_is_followed_at_once() -> None:
    clock = SourceClock()
    clock.captured_ns(10**12, 10**12, 10**9)
    assert clock.captured_ns(0, 0, 2 * 10**9) == 2 * 10**9


def test_ticks_that_begin_late_do_not_shift_what_was_received() -> None:
    """Ticks every 2 ms, late by 0.1 ms and more; packets every 3.3 ms: their order and distance stay."""
    rng = np.random.default_rng(4)
    now = [0]
    clock = ReceiptClock(lambda: now[0])
    received: list[int] = []
    for tick in range(1, 5_000):
        due_ns = 2_000_000 * tick
        now[0] = 10**18 + due_ns + 100_000 + round(rng.exponential(500_000))
        shift_ns = clock.shift_ns(due_ns)
        if tick % 5 == 0:
            received.append(now[0] + shift_ns - 300_000)
            assert received[-1] <= now[0] - 10**18
    assert all(later > earlier for earlier, later in pairwise(received))
    assert shift_ns + 10**18 == pytest.approx(-100_000, abs=20_000)
