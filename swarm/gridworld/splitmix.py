"""The engine's random numbers: SplitMix64, as `kernels` compiles it and here in plain Python.

One word of state and three multiplications a number; it passes BigCrush. Streams start at random words,
so that the 1e8 numbers of each of a study's thousand streams overlap with a probability of about 1e-5.
"""

from __future__ import annotations

import numpy as np

from swarm.learning.random import spawned_generator

GOLDEN = 0x9E3779B97F4A7C15
FIRST, SECOND = 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
"""SplitMix64's increment and multipliers (Steele, Lea and Flood, 2014)."""
WORD = 2**64 - 1
"""64 bits."""


class SplitMix64:
    """The twin of the engine's generator: an `Rng` for the plain controller."""

    def __init__(self, word: int) -> None:
        self.word = word

    def bits(self) -> int:
        """The next 64 random bits."""
        self.word = (self.word + GOLDEN) & WORD
        mixed = ((self.word ^ self.word >> 30) * FIRST) & WORD
        mixed = ((mixed ^ mixed >> 27) * SECOND) & WORD
        return mixed ^ mixed >> 31

    def random(self) -> float:
        """A number in [0, 1) of 53 random bits."""
        return (self.bits() >> 11) * 2.0**-53

    def integers(self, high: int, /) -> int:
        """A whole number in [0, high); off uniform by less than high / 2^32."""
        return (self.bits() >> 32) * high >> 32


def stream_word(seed: int, run: int, agent: str, component: str) -> int:
    """Where a stream starts.

    A condition's name is no part of it: the conditions of one (seed, run) are a pair, which meet the
    same numbers until imitation makes them differ.
    """
    generator = spawned_generator(seed, "gridworld", run, agent, component)
    return int(generator.integers(2**64, dtype=np.uint64))
