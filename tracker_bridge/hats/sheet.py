"""A sheet to build hats from, in their true size."""

from __future__ import annotations

import math
from xml.sax.saxutils import escape

from tracker_bridge.hats.patterns import Hat, PinGrid

COLUMNS, CELL_WIDTH_MM, CELL_HEIGHT_MM = 2, 105.0, 99.0
"""Six hats on a page of A4 (210 x 297 mm), none across a page's end."""
HOLE_RADIUS_MM, PIN_RADIUS_MM = 0.8, 4.0
"""A hole, and a marker of 8 mm."""
PLATE_RADIUS_MM = 38.0
"""A marker at the grid's rim lies on it whole."""


def sheet(hats: list[Hat], grid: PinGrid) -> str:
    """An SVG in millimetres: each hat from above, its front up, holes of the grid and the pins to set."""
    height_mm = CELL_HEIGHT_MM * math.ceil(len(hats) / COLUMNS)
    width_mm = COLUMNS * CELL_WIDTH_MM
    cells = "\n".join(_cell(number, hat, grid) for number, hat in enumerate(hats))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width_mm:g}mm" height="{height_mm:g}mm" '
        f'viewBox="0 0 {width_mm:g} {height_mm:g}" font-family="sans-serif" font-size="5">\n{cells}\n</svg>\n'
    )


def _cell(number: int, hat: Hat, grid: PinGrid) -> str:
    row, column = divmod(number, COLUMNS)
    x_mm, y_mm = (column + 0.5) * CELL_WIDTH_MM, (row + 0.5) * CELL_HEIGHT_MM + 3
    holes = "".join(_circle(hole, HOLE_RADIUS_MM, "none") for hole in grid.holes)
    pins = "".join(_circle(pin, PIN_RADIUS_MM, "black") for pin in hat.pins)
    tip_mm = -PLATE_RADIUS_MM
    return (
        f'<g transform="translate({x_mm:g} {y_mm:g})" stroke="black" stroke-width="0.2" fill="none">'
        f'<circle r="{PLATE_RADIUS_MM:g}"/><path d="M-3 {tip_mm + 5:g} L0 {tip_mm:g} L3 {tip_mm + 5:g}"/>'
        f'{holes}{pins}<text y="{tip_mm - 3:g}" text-anchor="middle" stroke="none" fill="black">'
        f"{escape(hat.name)}</text></g>"
    )


def _circle(place: complex, radius_mm: float, fill: str) -> str:
    """Ahead is up and left is left: the hat from above."""
    return f'<circle cx="{-1e3 * place.imag:g}" cy="{-1e3 * place.real:g}" r="{radius_mm:g}" fill="{fill}"/>'
