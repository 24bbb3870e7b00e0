"""The randomness that learning asks for, and where its seeds come from."""

from __future__ import annotations

import zlib
from typing import Protocol

import numpy as np


class Rng(Protocol):
    """What the learning rules need of a random generator; `numpy.random.Generator` has it."""

    def random(self) -> float:
        """A number in [0, 1)."""

    def integers(self, high: int, /) -> int | np.integer:
        """A whole number in [0, high)."""


def spawned_generator(
    seed: int, condition: str, trial: int, robot: str, component: str
) -> np.random.Generator:
    """The generator of one component of one robot in one trial, from the run's one root seed.

    Names enter by their CRC-32, so that adding a robot or a component changes no other stream.
    """
    names = (zlib.crc32(name.encode()) for name in (condition, robot, component))
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(trial, *names)))
