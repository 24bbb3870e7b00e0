"""Compass moves, grids of cells, and the compartments of the arena.

The arena frame has x east and y north, in metres, with its origin at the arena's south-west corner;
angles are counter-clockwise radians from east. Rows of a grid count from the north, so that
state 0 is the north-west cell: the paper's "top-left corner".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple


class Move(IntEnum):
    """One of the eight neighbours of a cell, in the order of the paper's figure 11."""

    E = 0
    SE = 1
    S = 2
    SW = 3
    W = 4
    NW = 5
    N = 6
    NE = 7

    @property
    def columns(self) -> int:
        """Cells to the east."""
        return (1, 1, 0, -1, -1, -1, 0, 1)[self]

    @property
    def rows(self) -> int:
        """Cells to the south."""
        return (0, 1, 1, 1, 0, -1, -1, -1)[self]

    @property
    def theta_rad(self) -> float:
        """Heading in the arena frame, in (-pi, pi]."""
        return wrap_angle_rad(-math.pi / 4 * self)


MOVES = len(Move)


def wrap_angle_rad(angle_rad: float) -> float:
    """The same direction in (-pi, pi]."""
    return math.pi - (math.pi - angle_rad) % math.tau


class Pose(NamedTuple):
    """A place and a heading in the arena frame."""

    x_m: float
    y_m: float
    theta_rad: float

    def compose(self, other: Pose) -> Pose:
        """The pose that `other`, given in this pose's frame, has in the frame of this pose."""
        cos, sin = math.cos(self.theta_rad), math.sin(self.theta_rad)
        return Pose(
            self.x_m + cos * other.x_m - sin * other.y_m,
            self.y_m + sin * other.x_m + cos * other.y_m,
            wrap_angle_rad(self.theta_rad + other.theta_rad),
        )

    def relative(self, other: Pose) -> Pose:
        """`other` as seen from this pose: the inverse of `compose`."""
        cos, sin = math.cos(self.theta_rad), math.sin(self.theta_rad)
        dx_m, dy_m = other.x_m - self.x_m, other.y_m - self.y_m
        return Pose(
            cos * dx_m + sin * dy_m,
            -sin * dx_m + cos * dy_m,
            wrap_angle_rad(other.theta_rad - self.theta_rad),
        )

    def distance_m(self, other: Pose) -> float:
        """Straight-line distance between the two places."""
        return math.hypot(other.x_m - self.x_m, other.y_m - self.y_m)


@dataclass(frozen=True)
class Grid:
    """Cells numbered row by row from the north-west; `obstacle` cells cannot be entered."""

    columns: int
    rows: int
    obstacle: frozenset[int] = frozenset()

    @property
    def states(self) -> int:
        return self.columns * self.rows

    @property
    def start(self) -> int:
        """The north-west cell, the paper's top-left corner."""
        return 0

    @property
    def goal(self) -> int:
        """The south-east cell, the paper's bottom-right corner."""
        return self.states - 1

    def state(self, column: int, row: int) -> int:
        return row * self.columns + column

    def cell(self, state: int) -> tuple[int, int]:
        """The column (from the west) and row (from the north) of a state."""
        return state % self.columns, state // self.columns

    def neighbour(self, state: int, move: int) -> int | None:
        """The cell that a move leads to; None if a wall or an obstacle is in the way."""
        column, row = self.cell(state)
        column, row = column + Move(move).columns, row + Move(move).rows
        if not (0 <= column < self.columns and 0 <= row < self.rows):
            return None
        entered = self.state(column, row)
        return None if entered in self.obstacle else entered


@dataclass(frozen=True)
class Compartment:
    """A walled part of the arena that belongs to one robot, divided into the cells of a grid."""

    west_m: float
    south_m: float
    grid: Grid
    cell_m: float

    @property
    def east_m(self) -> float:
        return self.west_m + self.grid.columns * self.cell_m

    @property
    def north_m(self) -> float:
        return self.south_m + self.grid.rows * self.cell_m

    def centre(self, state: int) -> tuple[float, float]:
        """The middle of a cell (x_m, y_m) in the arena frame."""
        column, row = self.grid.cell(state)
        return self.west_m + (column + 0.5) * self.cell_m, self.north_m - (row + 0.5) * self.cell_m

    def state_at(self, x_m: float, y_m: float) -> int | None:
        """The cell around a place; None outside the compartment."""
        column = math.floor((x_m - self.west_m) / self.cell_m)
        row = math.floor((self.north_m - y_m) / self.cell_m)
        inside = 0 <= column < self.grid.columns and 0 <= row < self.grid.rows
        return self.grid.state(column, row) if inside else None

    def overlaps(self, other: Compartment) -> bool:
        """Whether the two share more than a border."""
        slack_m = 1e-9
        return (
            self.west_m < other.east_m - slack_m
            and other.west_m < self.east_m - slack_m
            and self.south_m < other.north_m - slack_m
            and other.south_m < self.north_m - slack_m
        )
