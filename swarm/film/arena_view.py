"""The arena from above: compartments, where everybody is, and in its own compartment what the robot knows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from swarm.config.experiment import Experiment, RobotSettings
from swarm.film.canvas import BLUE, INK, ORANGE, QUIET, RULE, WHITE, Canvas, Colour, Point
from swarm.geometry import Compartment, Move, Pose
from swarm.learning.q_table import QTable

ROBOT_M = 0.035
"""An e-puck's radius."""
CARRIED_M = 0.1
"""Between two points of a trail: five times as far as a robot drives."""
ARROW = 0.3
"""Of a cell, from its middle: arrows of neighbours do not touch."""
PALE: Colour = (240, 245, 250)
DARK: Colour = (24, 92, 168)
OTHERS: Colour = (120, 120, 120)


@dataclass(frozen=True)
class ArenaView:
    """Draws into a square of the picture, (left, top) and its side in pixels."""

    experiment: Experiment
    robot: str
    left: int
    top: int
    side: int

    @property
    def scale(self) -> float:
        """Pixels a metre."""
        return self.side / max(self.experiment.arena.width_m, self.experiment.arena.height_m)

    def point(self, x_m: float, y_m: float) -> Point:
        """North is up."""
        return self.left + x_m * self.scale, self.top + (self.experiment.arena.height_m - y_m) * self.scale

    def draw_floor(self, canvas: Canvas) -> None:
        """What stays as it is: floor, compartments, names."""
        arena = self.experiment.arena
        canvas.box(self.point(0, arena.height_m), self.point(arena.width_m, 0), (250, 250, 248))
        canvas.box(self.point(0, arena.height_m), self.point(arena.width_m, 0), RULE, 2)
        for settings in self.experiment.robot:
            self._draw_compartment(canvas, settings)

    def _draw_compartment(self, canvas: Canvas, settings: RobotSettings) -> None:
        room = self.experiment.compartment(settings)
        for column in range(room.grid.columns + 1):
            x_m = room.west_m + column * room.cell_m
            canvas.line([self.point(x_m, room.south_m), self.point(x_m, room.north_m)], RULE)
        for row in range(room.grid.rows + 1):
            y_m = room.south_m + row * room.cell_m
            canvas.line([self.point(room.west_m, y_m), self.point(room.east_m, y_m)], RULE)
        corners = [(room.west_m, room.south_m), (room.west_m, room.north_m)]
        corners += [(room.east_m, room.north_m), (room.east_m, room.south_m), corners[0]]
        canvas.line([self.point(*corner) for corner in corners], QUIET, 2)
        left, top = self.point(room.west_m, room.north_m)
        shown = settings.id if settings.id == settings.group else f"{settings.id} ({settings.group})"
        canvas.text(shown, (left, top - 22), ORANGE if settings.id == self.robot else QUIET, 14)

    def draw_knowledge(self, canvas: Canvas, q: QTable) -> None:
        """The best Q of each cell as a shade, its best moves as arrows."""
        room = self.experiment.compartment(self.experiment.robot_named(self.robot))
        best = [q.best_value(state) for state in range(room.grid.states)]
        highest = max(best)
        for state, value in enumerate(best):
            if value > 0:
                share = value / highest
                self._draw_cell(canvas, room, state, _shade(share))
                if state != room.grid.goal:
                    for action in q.best_actions(state):
                        self._draw_arrow(canvas, room, state, Move(action), WHITE if share > 0.55 else INK)

    def _draw_cell(self, canvas: Canvas, room: Compartment, state: int, colour: Colour) -> None:
        x_m, y_m = room.centre(state)
        half_m = room.cell_m / 2
        west, north = self.point(x_m - half_m, y_m + half_m)
        east, south = self.point(x_m + half_m, y_m - half_m)
        canvas.box((west + 1, north + 1), (east - 1, south - 1), colour)

    def _draw_arrow(self, canvas: Canvas, room: Compartment, state: int, move: Move, colour: Colour) -> None:
        x, y = self.point(*room.centre(state))
        length = ARROW * room.cell_m * self.scale
        along, down = length * math.cos(move.theta_rad), -length * math.sin(move.theta_rad)
        canvas.line([(x - along, y - down), (x + along, y + down)], colour)
        head = [(x + along, y + down)]
        head += [(x + 0.3 * along - way * 0.4 * down, y + 0.3 * down + way * 0.4 * along) for way in (1, -1)]
        canvas.polygon(head, colour)

    def draw_trail(self, canvas: Canvas, poses: Sequence[Pose]) -> None:
        """Where the robot drove on this journey, without where it was carried."""
        for before, pose in pairwise(poses):
            if before.distance_m(pose) < CARRIED_M:
                ends = [self.point(each.x_m, each.y_m) for each in (before, pose)]
                canvas.line(ends, ORANGE, 2)

    def draw_robots(self, canvas: Canvas, poses: Iterable[tuple[str, Pose]]) -> None:
        """Discs with the way that each one faces; the film's robot last, so that it is never hidden."""
        for name, pose in sorted(poses, key=lambda each: each[0] == self.robot):
            self._draw_robot(canvas, pose, ORANGE if name == self.robot else OTHERS)

    def _draw_robot(self, canvas: Canvas, pose: Pose, colour: Colour) -> None:
        centre, radius = self.point(pose.x_m, pose.y_m), ROBOT_M * self.scale
        canvas.disc(centre, radius + 1.5, WHITE)
        canvas.disc(centre, radius, colour)
        nose = centre[0] + radius * math.cos(pose.theta_rad), centre[1] - radius * math.sin(pose.theta_rad)
        canvas.line([centre, nose], WHITE, 2)

    def draw_path(self, canvas: Canvas, cells: Sequence[int]) -> None:
        """The cells that the path being replayed leads through."""
        room = self.experiment.compartment(self.experiment.robot_named(self.robot))
        canvas.line([self.point(*room.centre(state)) for state in cells], BLUE, 3)


def _shade(share: float) -> Colour:
    """From pale to dark by a share of the highest."""
    red, green, blue = (round(pale + (dark - pale) * share) for pale, dark in zip(PALE, DARK, strict=True))
    return red, green, blue
