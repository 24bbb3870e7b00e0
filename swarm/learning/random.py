"""The randomness that learning asks for, and where its seeds come from."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np


class Rng(Protocol):
    """What the learning rules need of a random generator; `numpy.random.Generator` has it."""

    def random(self) -> float:
        """A number in [0, 1)."""

    def integers(self, high: int, /) -> int | np.integer:
        """A whole number in [0, high)."""


RngState = Mapping[str, Any]
"""The state of a numpy generator, as JSON can hold it."""


def rng_state(rng: Rng) -> RngState:
    """What `restore_rng` needs to go on with the same numbers; only a numpy generator has it."""
    return _numpy_generator(rng).bit_generator.state


def restore_rng(rng: Rng, state: RngState) -> None:
    """Go on with the numbers that would have followed when `rng_state` was asked."""
    _numpy_generator(rng).bit_generator.state = state


def _numpy_generator(rng: Rng) -> np.random.Generator:
    if not isinstance(rng, np.random.Generator):
        raise TypeError(f"the state of a {type(rng).__name__} cannot be saved: use a numpy generator")
    return rng


def spawned_generator(
    seed: int, condition: str, trial: int, robot: str, component: str
) -> np.random.Generator:
    """The generator of one component of one robot in one trial, from the run's one root seed.

    Names enter by their CRC-32, so that adding a robot or a component changes no other stream.
    """
    names = (zlib.crc32(name.encode()) for name in (condition, robot, component))
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(trial, *names)))
