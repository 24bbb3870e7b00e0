"""Compilation by numba, which keeps what it compiled beside the source or in the user's cache, if it can."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function, **options: Any) -> Function:
    """The function compiled at its first call.

    Where nothing can be kept, as in somebody else's installation without a home of one's own, it is compiled
    anew in every process, which takes some seconds.
    """
    try:
        return cast(Function, njit(cache=True, **options)(function))
    except RuntimeError:  # numba: "no locator available for file"
        return cast(Function, njit(**options)(function))
