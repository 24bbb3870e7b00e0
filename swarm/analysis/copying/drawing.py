"""Moves drawn as arrows from cell to cell: east to the right, south down."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from matplotlib.axes import Axes

from swarm.geometry import Move

Point = tuple[float, float]
"""(cells to the east, cells to the south)."""

LANE = 0.09
"""In cells: arrows keep so far to the right, so that a way there and the way back are both seen."""
LEAST_SIDE = 6.0
MARGIN = 0.8
GRID = "#e6e6e6"
FRAME = "#d0d0d0"


@dataclass(frozen=True)
class Square:
    """The part of the plane that a picture shows."""

    middle: Point
    side: float


def places(moves: Iterable[int]) -> list[Point]:
    """The cells that moves lead through, from (0, 0) on."""
    found = [(0.0, 0.0)]
    for move in moves:
        east, south = found[-1]
        found.append((east + Move(move).columns, south + Move(move).rows))
    return found


def moves_text(moves: Sequence[int]) -> str:
    """Moves in words, equal ones counted: "2 NW, 5 SE"."""
    return ", ".join(f"{len(list(run))} {Move(move).name}" for move, run in groupby(moves)) or "no move"


def square_around(*lines: Sequence[Point]) -> Square:
    """A square with room for all lines."""
    east = [point[0] for line in lines for point in line]
    south = [point[1] for line in lines for point in line]
    middle = ((min(east) + max(east)) / 2, (min(south) + max(south)) / 2)
    extent = max(max(east) - min(east), max(south) - min(south))
    return Square(middle, max(extent + 2 * MARGIN, LEAST_SIDE))


def draw_cells(axes: Axes, square: Square) -> None:
    """The borders of cells, around whose middles the moves lead, and nothing else."""
    (east, south), half = square.middle, square.side / 2
    axes.set_xlim(east - half, east + half)
    axes.set_ylim(south + half, south - half)
    axes.set_aspect("equal")
    axes.set_xticks(_borders(east, half), labels=[])
    axes.set_yticks(_borders(south, half), labels=[])
    axes.tick_params(length=0)
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    for spine in axes.spines.values():
        spine.set_color(FRAME)


def draw_moves(axes: Axes, moves: Sequence[int], colours: Sequence[str]) -> None:
    """An arrow for each move, in its colour, and a ring around the start."""
    line = places(moves)
    axes.scatter(*line[0], s=80, color="white", edgecolors=(*colours, FRAME)[0], linewidths=1.5, zorder=4.5)
    steps = list(pairwise(line))
    lanes = [_lane(step) for step in steps]
    axes.quiver(
        [begin[0] + lane[0] for (begin, _), lane in zip(steps, lanes, strict=True)],
        [begin[1] + lane[1] for (begin, _), lane in zip(steps, lanes, strict=True)],
        [end[0] - begin[0] for begin, end in steps],
        [end[1] - begin[1] for begin, end in steps],
        color=list(colours),
        angles="xy",
        scale_units="xy",
        scale=1,
        units="xy",
        width=0.1,
        headwidth=4,
        headlength=4,
        headaxislength=3.6,
        zorder=4,
    )


def _borders(middle: float, half: float) -> list[float]:
    first, last = int(middle - half) - 1, int(middle + half) + 1
    return [cell + 0.5 for cell in range(first, last + 1) if abs(cell + 0.5 - middle) <= half]


def _lane(step: tuple[Point, Point]) -> Point:
    """A shift to the right of the way; south counts downwards."""
    (east, south), (next_east, next_south) = step
    along_east, along_south = next_east - east, next_south - south
    length = (along_east**2 + along_south**2) ** 0.5
    return -LANE * along_south / length, LANE * along_east / length
