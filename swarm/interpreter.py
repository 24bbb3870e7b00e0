"""How the commands start Python processes: with the same modules, and none from the working directory."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

SAFE_PATH = "PYTHONSAFEPATH"
"""With it Python adds neither the working directory nor a script's to the places that it imports from."""


def module_command(module: str, *arguments: str) -> list[str]:
    """The command line that runs a module as this interpreter would; start it with `child_environment()`."""
    return [sys.executable, "-m", module, *arguments]


def child_environment() -> dict[str, str]:
    """This process's environment for a Python process that finds its modules where this one does.

    A user's own `server.py` or `numpy.py` in the working directory is no part of the swarm.
    """
    places = os.pathsep.join(place for place in sys.path if place)
    return {**os.environ, SAFE_PATH: "1", "PYTHONPATH": places}


@contextmanager
def safe_path() -> Iterator[None]:
    """What starts Python processes of its own inside the block, such as a pool, has them import safely."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before
