"""`tracker-bridge hats generate|check|sheet`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from swarm.errors import UserError
from swarm.files import new_file
from tracker_bridge.hats.design import LEAST_SPACING_M, design_hats
from tracker_bridge.hats.examination import examine
from tracker_bridge.hats.hat_file import hats_as_toml, load_hats
from tracker_bridge.hats.patterns import PinGrid
from tracker_bridge.hats.sheet import sheet

TOLERANCE_MM = 5.0
"""Hats that differ by so much are told apart by markers with 1 mm of noise within a tenth of a second."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    steps = parser.add_subparsers(dest="step", required=True, metavar="generate|check|sheet")
    generate = steps.add_parser("generate", help="a set of patterns that are as different as can be")
    generate.add_argument("--count", type=int, required=True, help="how many hats")
    generate.add_argument("--prefix", default="r", help="hats are named PREFIX1, PREFIX2, ... (%(default)s)")
    generate.add_argument(
        "--spacing-mm", type=float, default=1e3 * LEAST_SPACING_M, help="between pins, at least"
    )
    _add_grid(generate)
    generate.set_defaults(call=_generate)
    check = steps.add_parser("check", help="what could be mistaken in a set of hats")
    check.add_argument("hats", type=Path, metavar="HATS.toml")
    check.add_argument("--tolerance-mm", type=float, default=TOLERANCE_MM, help="(%(default)s)")
    check.add_argument("--json", action="store_true", help="print it for a program")
    check.set_defaults(call=_check)
    drawing = steps.add_parser("sheet", help="an SVG in true size to build the hats from")
    drawing.add_argument("hats", type=Path, metavar="HATS.toml")
    drawing.add_argument("--out", type=Path, required=True, metavar="FILE.svg")
    _add_grid(drawing)
    drawing.set_defaults(call=_sheet)


def run(arguments: argparse.Namespace) -> None:
    arguments.call(arguments)


def _add_grid(parser: argparse.ArgumentParser) -> None:
    usual = PinGrid()
    parser.add_argument("--columns", type=int, default=usual.columns, help="of holes (%(default)s)")
    parser.add_argument("--rows", type=int, default=usual.rows, help="of holes (%(default)s)")
    parser.add_argument("--pitch-mm", type=float, default=1e3 * usual.pitch_m, help="(%(default)s)")
    parser.add_argument(
        "--radius-mm", type=float, default=1e3 * usual.radius_m, help="of the plate (%(default)s)"
    )


def _grid(arguments: argparse.Namespace) -> PinGrid:
    grid = PinGrid(arguments.columns, arguments.rows, arguments.pitch_mm / 1e3, arguments.radius_mm / 1e3)
    if not 4 <= len(grid.holes) <= 40:
        raise UserError(f"the grid has {len(grid.holes)} holes within its radius; it has to have 4 to 40")
    return grid


def _generate(arguments: argparse.Namespace) -> None:
    if arguments.count < 1:
        raise UserError(f"--count is {arguments.count}; at least 1 hat is wanted")
    grid = _grid(arguments)
    hats = design_hats(grid, arguments.count, spacing_m=arguments.spacing_mm / 1e3, prefix=arguments.prefix)
    least_mm = 1e3 * examine(hats, 0.0).least_difference_m
    print(f"# {len(hats)} hats on a grid of {arguments.columns} x {arguments.rows} holes, ", end="")
    print(f"{arguments.pitch_mm:g} mm apart; any two differ by {least_mm:.1f} mm or more\n")
    print(hats_as_toml(hats), end="")


def _check(arguments: argparse.Namespace) -> None:
    examination = examine(load_hats(arguments.hats), arguments.tolerance_mm / 1e3)
    least_mm = round(1e3 * examination.least_difference_m, 2)
    if arguments.json:
        print(json.dumps({"least_difference_mm": least_mm, "findings": examination.findings}))
        return
    print(f"the hats differ by {least_mm:g} mm or more")
    for finding in examination.findings:
        print(finding)


def _sheet(arguments: argparse.Namespace) -> None:
    drawing = sheet(load_hats(arguments.hats), _grid(arguments))
    with new_file(arguments.out) as file:
        file.write(drawing.encode())
