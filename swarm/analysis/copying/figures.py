"""Figures 27 to 29 for any run: paths enacted most and least, and originals beside their copies."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from swarm.analysis.copying.drawing import (
    Point,
    Square,
    draw_cells,
    draw_moves,
    moves_text,
    places,
    square_around,
)
from swarm.analysis.copying.errors import ErrorKind, differences
from swarm.analysis.copying.paths import LoggedPath, Seen
from swarm.analysis.copying.ratios import plot_ratios
from swarm.analysis.copying.summary import Copying, chosen_copies, least_enacted, most_enacted
from swarm.analysis.plots import COLOURS, GREY
from swarm.markdown import counted

PERFECT, WRONG, UNJUDGED = COLOURS[0], COLOURS[1], GREY
"""Blue, orange and grey: told apart by everybody."""
CAPTION_LETTERS, CAPTION_LINES = 38, 2
"""What fits under half of an original with its copy."""
NOTE_LETTERS_AN_INCH = 15
"""Of a note's small letters."""
PATH_WIDTH_IN, NOTE_SPACE_IN, WORDS_IN = 2.9, 0.4, 1.9
"""Inches: of each path, beside them all, and above and below them."""
CASE_HEIGHT_IN, NOTE_HEIGHT_IN = 4.3, 0.6
"""Inches: of an original with its copy, whose captions take four lines, and of the note below them all."""
_SEEN = "#1a1a1a"
_R_NOTE = "Moves are drawn from the ring on, a cell a move. R as in equation 4, after the last replay."
_SEEN_NOTE = (
    "Dots: where the observer saw the other robot. Orange: moves that were copied wrongly, or of which there "
    "is no copy."
)


def copying_figures(copying: Copying) -> dict[str, Figure]:
    """Every figure that there is something for, by file name."""
    found: dict[str, Figure] = {}
    if copying.paths:
        found["most_enacted.png"] = plot_paths(most_enacted(copying), "Paths enacted most often")
        found["least_enacted.png"] = plot_paths(least_enacted(copying), "Paths enacted least often")
        found["ratios.png"] = plot_ratios(copying.paths, copying.replays, colour_of)
    if copies := chosen_copies(copying.enacted):
        found["copies.png"] = plot_copies(copies, copying)
    return found


def colour_of(path: LoggedPath) -> str:
    """Blue for a perfect copy, orange for a wrong one, grey for what was given or not judged."""
    if path.error is None:
        return UNJUDGED
    return PERFECT if path.error is ErrorKind.PERFECT else WRONG


def source_text(path: LoggedPath) -> str:
    """How the robot came by a path."""
    if path.error is None:
        return "given" if path.source == "given" else "copied"
    return "a perfect copy" if path.error is ErrorKind.PERFECT else f"copied with {_WITH[path.error]}"


_WITH = {
    ErrorKind.EXTRA: "one move extra",
    ErrorKind.LOST: "one move lost",
    ErrorKind.HEADING: "one heading wrong",
    ErrorKind.SEVERAL: "several errors",
}


def plot_paths(paths: Sequence[LoggedPath], title: str) -> Figure:
    """Remembered paths side by side with their R and replays."""
    size = PATH_WIDTH_IN * len(paths) + NOTE_SPACE_IN, PATH_WIDTH_IN + WORDS_IN
    figure = Figure(figsize=size, layout="constrained")
    figure.suptitle(title, fontsize=13, fontweight="bold", x=0.01, ha="left")
    columns = figure.subplots(1, len(paths), squeeze=False)[0]
    lines = [places(path.moves) for path in paths]
    side = max(square_around(line).side for line in lines)
    for axes, path, line in zip(columns, paths, lines, strict=True):
        draw_cells(axes, Square(square_around(line).middle, side))
        draw_moves(axes, path.moves, [colour_of(path)] * len(path.moves))
        _caption(axes, path)
    figure.supxlabel(_wrapped_note(_R_NOTE, figure), x=0.01, ha="left", fontsize=8.5, color=GREY)
    return figure


def _caption(axes: Axes, path: LoggedPath) -> None:
    axes.set_title(
        f"{_replays(path)}, R {path.ratio:.2f}", fontsize=11, fontweight="bold", loc="left", pad=20
    )
    axes.text(0, 1.025, _name(path), **_small(axes), color=GREY)
    source = f"{source_text(path)},\nknown for {path.known_for:,} moves"
    axes.set_xlabel(source, fontsize=9.5, color=colour_of(path), loc="left")


def _small(axes: Axes) -> dict[str, Any]:
    return {"fontsize": 8.5, "transform": axes.transAxes, "va": "bottom"}


def _replays(path: LoggedPath) -> str:
    return counted(path.replays, "replay")


def _name(path: LoggedPath) -> str:
    return f"{path.robot}, trial {path.trial}, path {path.path}"


def plot_copies(paths: Sequence[LoggedPath], copying: Copying) -> Figure:
    """What the demonstrator really did on the left, what was perceived on the right, two copies a row."""
    columns = min(len(paths), 2)
    rows = -(-len(paths) // columns)
    figure = Figure(figsize=(5.8 * columns, CASE_HEIGHT_IN * rows + NOTE_HEIGHT_IN), layout="constrained")
    figure.suptitle("Original and perceived copy", fontsize=13, fontweight="bold", x=0.01, ha="left")
    heights = [CASE_HEIGHT_IN] * rows + [NOTE_HEIGHT_IN]
    *cases, note = figure.subfigures(rows + 1, columns, squeeze=False, wspace=0.04, height_ratios=heights)
    for case, path in zip(np.ravel(cases), paths, strict=False):
        _draw_case(case, path, copying.seen.get(path, ()))
    note[0].text(0.01, 0.5, _wrapped_note(_SEEN_NOTE, figure), va="center", fontsize=8.5, color=GREY)
    return figure


def _draw_case(case: SubFigure, path: LoggedPath, seen: Seen) -> None:
    real, copied = path.real or (), path.copied or ()
    wrong = differences(copied, real)
    title = f"{_name(path)}: {_replays(path)}, R {path.ratio:.2f}"
    case.suptitle(title, fontsize=10.5, fontweight="bold", x=0.02, ha="left")
    left, right = case.subplots(1, 2)
    shown = square_around(places(real)), square_around(places(copied), seen)
    side = max(square.side for square in shown)
    _draw_side(left, real, wrong.real, GREY, Square(shown[0].middle, side))
    _draw_side(right, copied, wrong.copied, PERFECT, Square(shown[1].middle, side), seen)
    left.set_title("what was really done", fontsize=9.5, color=GREY, loc="left")
    right.set_title(source_text(path), fontsize=9.5, color=colour_of(path), loc="left")
    left.set_xlabel(_wrapped(f"done: {moves_text(real)}"), fontsize=9, loc="left")
    copy = [f"perceived: {moves_text(copied)}", f"remembered: {moves_text(path.moves)}"]
    right.set_xlabel("\n".join(map(_wrapped, copy)), fontsize=9, loc="left")


def _wrapped_note(text: str, figure: Figure) -> str:
    """In lines that are no wider than the figure."""
    return "\n".join(textwrap.wrap(text, int(figure.get_figwidth() * NOTE_LETTERS_AN_INCH)))


def _wrapped(text: str) -> str:
    """In lines, none of which ends between a number and its move."""
    text = re.sub(r"(\d) ", "\\1\N{NO-BREAK SPACE}", text)
    return "\n".join(textwrap.wrap(text, CAPTION_LETTERS, max_lines=CAPTION_LINES, placeholder=" …"))


def _draw_side(
    axes: Axes,
    moves: Sequence[int],
    wrong: frozenset[int],
    colour: str,
    square: Square,
    seen: Sequence[Point] = (),
) -> None:
    draw_cells(axes, square)
    draw_moves(axes, moves, [WRONG if place in wrong else colour for place in range(len(moves))])
    if seen:
        east, south = zip(*seen, strict=True)
        axes.scatter(east, south, s=5, color=_SEEN, linewidths=0, zorder=5, alpha=0.7)
