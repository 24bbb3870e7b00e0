"""Sets of moves, one bit a move, as tables that the kernels look members up in."""

from __future__ import annotations

import numpy as np

from swarm.geometry import MOVES

ALL_MOVES = (1 << MOVES) - 1  # a set has a bit for each of its moves
SETS = [[move for move in range(MOVES) if mask >> move & 1] for mask in range(ALL_MOVES + 1)]
SIZE = np.array([len(members) for members in SETS], np.uint8)
"""How many actions a set has (256,)."""
MEMBER = np.array([members + [0] * (MOVES - len(members)) for members in SETS], np.uint8).ravel()
"""The k-th action of a set, at 8 x set + k (2048,)."""
FIRST_MEMBER = MEMBER[::MOVES].copy()
"""The first action of a set (256,)."""
