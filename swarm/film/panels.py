"""What stands beside the arena: the robot's camera, and its learning curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from swarm.clock import NS_PER_S
from swarm.film.camera import CameraFrame, SeenFrames
from swarm.film.canvas import BLUE, GREEN, INK, ORANGE, QUIET, RULE, Canvas, Point
from swarm.film.knowledge import MemoryLine

MEMORY_LINES = 11
"""The paper's ten paths, and one more; of a larger memory the newest."""
LINE_PIXELS, R_PIXELS = 27, 120
"""Eleven lines fill the place of the camera's picture."""
SAID_SIGNS = 56
"""So many letters fit beside the name."""
LATEST_NS = NS_PER_S
"""A frame older than a second is of a visit that is over."""


@dataclass(frozen=True)
class CameraPanel:
    """The newest frame, and where the demonstrator was found in it."""

    seen: SeenFrames
    left: int
    top: int
    width: int
    height: int

    def draw(self, canvas: Canvas, t_ns: int) -> bool:
        """Whether there is a frame to show."""
        frame = self.seen.at(t_ns)
        if frame is None or t_ns - frame.t_ns > LATEST_NS:
            return False
        canvas.text("camera", (self.left, self.top - 26), INK, 16, bold=True)
        canvas.picture(frame.pixels, (self.left, self.top), (self.width, self.height))
        self._draw_sighting(canvas, frame)
        return True

    def _draw_sighting(self, canvas: Canvas, frame: CameraFrame) -> None:
        look = self.seen.looks[frame.t_ns]
        if frame.column is None:
            words, colour = f"not seen: {look.not_seen}", ORANGE
        else:
            words, colour = f"seen at {look.range_m:.2f} m", GREEN
            x = self.left + (frame.column + 0.5) * self.width / frame.pixels.shape[1]
            for top, bottom in ((0, 0.12), (0.88, 1)):
                ends: list[Point] = [(x, self.top + share * self.height) for share in (top, bottom)]
                canvas.line(ends, colour, 3)
        canvas.box(
            (self.left, self.top + self.height), (self.left + self.width, self.top + self.height + 4), colour
        )
        canvas.text(words, (self.left + 80, self.top - 24), colour, 14)


def draw_memory(canvas: Canvas, corner: tuple[int, int], memory: Sequence[MemoryLine], said: str) -> None:
    """What the robot remembers, shown while it does not watch: each path with its R as a bar."""
    left, top = corner
    canvas.text("memory", (left, top - 26), INK, 16, bold=True)
    canvas.text(
        said if len(said) <= SAID_SIGNS else f"{said[:SAID_SIGNS]}...", (left + 90, top - 24), QUIET, 14
    )
    for place, line in enumerate(memory[-MEMORY_LINES:]):
        y = top + 4 + place * LINE_PIXELS
        colour = ORANGE if line.is_replayed else INK
        canvas.text(f"{line.path}", (left, y), colour, 14)
        canvas.box((left + 34, y + 3), (left + 34 + R_PIXELS, y + 15), (236, 236, 234))
        canvas.box(
            (left + 34, y + 3),
            (left + 34 + R_PIXELS * min(1.0, line.ratio), y + 15),
            ORANGE if line.is_replayed else BLUE,
        )
        canvas.text(
            f"R {line.ratio:.2f}   {line.replays:,} replays   {line.moves}",
            (left + 46 + R_PIXELS, y),
            colour,
            14,
        )


@dataclass(frozen=True)
class Curve:
    """Best path lengths of one learner."""

    name: str
    moves: Sequence[int]
    lengths: Sequence[int]
    is_of_film: bool


@dataclass(frozen=True)
class CurvePanel:
    """The curves of all learners, that of the film's robot up to where it is."""

    curves: Sequence[Curve]
    end: int
    cap: int
    left: int
    top: int
    width: int
    height: int

    def draw_axes(self, canvas: Canvas) -> None:
        """What stays as it is: axes, names, and the other learners' curves."""
        canvas.text("best path (moves)", (self.left, self.top - 24), INK, 16, bold=True)
        for length in range(0, self.cap + 1, max(1, self.cap // 5)):
            _, y = self._point(0, length)
            canvas.line([(self.left, y), (self.left + self.width, y)], RULE)
            canvas.text(f"{length:>3}", (self.left - 30, y - 8), QUIET, 12)
        step = _round(self.end / 4)
        for move in range(0, self.end + 1, step):
            x, y = self._point(move, 0)
            canvas.text(f"{move:,}", (x - 4 * len(f"{move:,}"), y + 6), QUIET, 12)
        names = [curve.name for curve in self.curves if not curve.is_of_film]
        for curve in self.curves:
            if not curve.is_of_film:
                self._draw(canvas, curve, self.end, faint=True)
        if names:
            canvas.text(f"grey: {', '.join(names)}", (self.left + 170, self.top - 22), QUIET, 13)

    def draw(self, canvas: Canvas, move: int) -> None:
        """Up to a move, with a rule there."""
        for curve in self.curves:
            if curve.is_of_film:
                self._draw(canvas, curve, move, faint=False)
        canvas.line([self._point(move, 0), self._point(move, self.cap)], ORANGE, 2)

    def _draw(self, canvas: Canvas, curve: Curve, end: int, *, faint: bool) -> None:
        points = [
            self._point(move, length)
            for move, length in zip(curve.moves, curve.lengths, strict=True)
            if move <= end
        ]
        canvas.line(points, (190, 190, 190) if faint else BLUE, 1 if faint else 2)

    def _point(self, move: float, length: float) -> Point:
        share = min(1.0, length / self.cap)
        return self.left + self.width * move / self.end, self.top + self.height * (1 - share)


def _round(step: float) -> int:
    """The next of 1, 2, 5, 10, 20 and so on."""
    size = 1
    while True:
        for factor in (1, 2, 5):
            if factor * size >= step:
                return factor * size
        size *= 10
