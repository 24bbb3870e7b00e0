"""Corners to compass moves: the most probable way over a lattice of cells whose place is not known.

Every corner is a noisy look at a lattice point. A hypothesis says how many cells, and in which of the
eight headings, lie between each corner and the next. Given that, all corners together tell where the
lattice lies (its offset, which a Kalman filter estimates), so a length is rounded with the evidence of the
whole demonstration instead of two noisy ends. The offset drifts from corner to corner, which keeps an error
of the observer's heading from adding up. A beam search keeps the best hypotheses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.segments import Vertex
from robot_agent.imitation.trajectory import Floats
from swarm.geometry import MOVES, Move

MOST_CELLS = 9
"""The longest straight way in the paper's grid of 10 x 10 cells."""
STOP_SD_M = 0.008
"""How far from a cell's centre the demonstrator stops. Chosen above the 2 to 3 mm of docs/results.md:
other robots may be worse."""
DRIFT_SD_M = 0.011
"""How much the lattice seems to move from corner to corner: enough to bear an own heading 5 degrees wrong
(docs/copying.md has what less and more of it cost)."""
PASSED_CHI2 = 1.0
"""Price of each cell that was passed without a stop: the prior of a prototype's best reader."""
STAY_CHI2 = 2.0
"""Price of a drive that led nowhere. Chosen, as the two below: the rarer the dearer; the bars of the
copying benchmark (tests/benchmarks/copying.py) hold them together."""
SKIP_CHI2 = 10.0
"""Price of a stop that was none, such as a slow moment between two cells."""
BEND_CHI2 = 3.0
"""Price of a corner without a stop; to skip such a corner is free."""
BEAM = 32
"""Chosen: bounds the work at 32 x 73 readings a corner; the right one is seldom far from the best."""

HEADINGS = np.append(np.repeat(np.arange(MOVES), MOST_CELLS), 0)
CELLS = np.append(np.tile(np.arange(1, MOST_CELLS + 1), MOVES), 0)
STAY = len(CELLS) - 1
SKIP = -1
OPTIONS_CELLS = (
    CELLS[:, None] * np.array([(move.columns, -move.rows) for move in Move], dtype=float)[HEADINGS]
)
"""[73, 2] east and north: each heading with each number of cells, and last to stay."""
OPTIONS_CHI2 = np.where(CELLS > 0, PASSED_CHI2 * (CELLS - 1), STAY_CHI2)


@dataclass(frozen=True)
class Stretch:
    """`cells` moves in one heading, which end at a vertex; none if the drive led nowhere or was skipped."""

    vertex: int
    move: Move
    cells: int
    confidence: float
    """How much worse, in chi2, the best list is that reads this stretch otherwise."""


@dataclass(frozen=True)
class _Beam:
    """H hypotheses: what each cost, chose, and where it puts the lattice and the demonstrator on it."""

    chi2: Floats  # [H]
    choices: NDArray[np.int64]  # [H, corners so far]
    driven_m: Floats  # [H, 2]
    offset_m: Floats  # [H, 2]
    covariance_m2: Floats  # [H, 2, 2] of the offset


def read_moves(vertices: Sequence[Vertex], cell_m: float) -> list[Stretch]:
    """The most probable stretches; those without a move are left out."""
    if len(vertices) < 2:
        return []
    beam = _start(vertices[0])
    for vertex in vertices[1:]:
        beam = _extend(beam, vertex, cell_m)
    return [
        Stretch(i + 1, Move(int(HEADINGS[choice])), int(CELLS[choice]), _gap(beam, i))
        for i, choice in enumerate(beam.choices[0])
        if choice not in (SKIP, STAY)
    ]


def _start(vertex: Vertex) -> _Beam:
    covariance_m2 = vertex.covariance_m2 + STOP_SD_M**2 * np.eye(2)
    nothing = np.zeros((1, 0), dtype=np.int64)
    return _Beam(np.zeros(1), nothing, np.zeros((1, 2)), vertex.xy_m[None], covariance_m2[None])


def _extend(beam: _Beam, vertex: Vertex, cell_m: float) -> _Beam:
    """Every hypothesis with every reading of one more corner, and the best of these."""
    predicted_m2 = beam.covariance_m2 + DRIFT_SD_M**2 * np.eye(2)
    weight = np.linalg.inv(predicted_m2 + vertex.covariance_m2 + STOP_SD_M**2 * np.eye(2))
    surprise_m = (vertex.xy_m - beam.driven_m - beam.offset_m)[:, None] - cell_m * OPTIONS_CELLS
    distances = np.einsum("hoi,hij,hoj->ho", surprise_m, weight, surprise_m)
    price = 0.0 if vertex.stopped else BEND_CHI2
    costs = (beam.chi2[:, None] + distances + OPTIONS_CHI2 + price).ravel()
    best = np.argsort(costs, kind="stable")[:BEAM]
    parent, option = np.divmod(best, len(CELLS))
    gain = predicted_m2 @ weight
    read = _Beam(
        costs[best],
        np.column_stack((beam.choices[parent], option)),
        beam.driven_m[parent] + cell_m * OPTIONS_CELLS[option],
        beam.offset_m[parent] + np.einsum("hij,hj->hi", gain[parent], surprise_m[parent, option]),
        (predicted_m2 - gain @ predicted_m2)[parent],
    )
    return _best(read, _skip(beam, predicted_m2, SKIP_CHI2 if vertex.stopped else 0.0))


def _skip(beam: _Beam, predicted_m2: Floats, price: float) -> _Beam:
    """Every hypothesis that the corner is none: nothing is learnt from it."""
    skipped = np.full(len(beam.chi2), SKIP)
    choices = np.column_stack((beam.choices, skipped))
    return _Beam(beam.chi2 + price, choices, beam.driven_m, beam.offset_m, predicted_m2)


def _best(one: _Beam, other: _Beam) -> _Beam:
    """The best hypotheses of two beams, the best first."""
    best = np.argsort(np.concatenate((one.chi2, other.chi2)), kind="stable")[:BEAM]
    return _Beam(
        np.concatenate((one.chi2, other.chi2))[best],
        np.concatenate((one.choices, other.choices))[best],
        np.concatenate((one.driven_m, other.driven_m))[best],
        np.concatenate((one.offset_m, other.offset_m))[best],
        np.concatenate((one.covariance_m2, other.covariance_m2))[best],
    )


def _gap(beam: _Beam, corner: int) -> float:
    """To the best hypothesis that reads a corner otherwise; to the beam's worst if none is left in it."""
    otherwise = beam.chi2[beam.choices[:, corner] != beam.choices[0, corner]]
    rival = otherwise[0] if len(otherwise) else beam.chi2[-1]
    return float(rival - beam.chi2[0])
