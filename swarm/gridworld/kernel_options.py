"""How the kernels are compiled, and what their numbers are to a type checker."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from swarm.compilation import compiled

Whole = int | np.int64 | Any
Real = float | Any
Truth = bool | Any
Word = np.uint64 | Any
Function = TypeVar("Function", bound=Callable[..., Any])

# Without numba's reference counts, which cost far more than the learning: nothing here allocates.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}


def called(function: Function) -> Function:
    """Compile as a function of its own."""
    return compiled(function, **_OPTIONS)


def inlined(function: Function) -> Function:
    """Compile into whatever calls it."""
    return compiled(function, forceinline=True, **_OPTIONS)
