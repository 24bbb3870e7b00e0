"""The engine's generator gives SplitMix64's published numbers, and streams that do not meet."""

from __future__ import annotations

import numpy as np

from swarm.gridworld.splitmix import SplitMix64, stream_word


def test_first_numbers_are_the_published_ones() -> None:
    rng = SplitMix64(1234567)
    assert [rng.bits() for _ in range(5)] == [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
        4593380528125082431,
        16408922859458223821,
    ]


def test_numbers_are_uniform() -> None:
    rng = SplitMix64(1)
    numbers = np.array([rng.random() for _ in range(20_000)])
    assert numbers.min() >= 0.0
    assert numbers.max() < 1.0
    assert abs(numbers.mean() - 0.5) < 0.01
    counts = np.bincount([rng.integers(7) for _ in range(21_000)], minlength=7)
    assert counts.size == 7
    assert abs(counts - 3_000).max() < 250


def test_every_name_moves_the_stream() -> None:
    words = {
        stream_word(seed, run, agent, component)
        for seed in (0, 1)
        for run in (0, 1)
        for agent in ("one", "two")
        for component in ("choices", "watching")
    }
    assert len(words) == 16
    assert stream_word(3, 4, "one", "choices") == stream_word(3, 4, "one", "choices")
