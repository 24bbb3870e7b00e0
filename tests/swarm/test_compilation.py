"""Compiled functions where nothing that was compiled can be kept."""

from __future__ import annotations

import subprocess
import sys

from tests.support.swarm_runs import ROOT

PROGRAM = """
import numba.core.caching as caching
caching.CacheImpl._locator_classes = []
from swarm.gridworld import kernels
from swarm.compilation import compiled
print(compiled(lambda x: x + 1)(41))
"""
"""As in somebody else's installation without a home of one's own: numba finds no place at all."""


def test_without_a_place_for_a_cache_functions_are_compiled_anew() -> None:
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "42\n", "")
