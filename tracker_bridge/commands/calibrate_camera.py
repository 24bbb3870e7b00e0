"""`tracker-bridge calibrate camera lens|place`: the lens from a board, the place from tags on the floor."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from swarm.files import new_file
from tracker_bridge.overhead.arena_view import (
    corners_of_known_tags,
    undistorted_lens,
    view_from_known_points,
)
from tracker_bridge.overhead.frames import pictures_of, read_picture
from tracker_bridge.overhead.lens import Board, find_lens
from tracker_bridge.overhead.settings import Calibration, OverheadSettings, load_settings
from tracker_bridge.overhead.tags import Tag, TagDetector, TagFamily

Floats = npt.NDArray[np.float64]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    steps = parser.add_subparsers(dest="step", required=True, metavar="lens|place")
    lens = steps.add_parser("lens", help="from pictures of a chessboard or charuco board")
    lens.add_argument("pictures", type=Path, metavar="PICTURES", help="a folder of pictures, or a video")
    lens.add_argument("--squares", required=True, metavar="COLUMNSxROWS", help="of the board, such as 10x7")
    lens.add_argument("--square-mm", type=float, required=True, help="side of a square")
    lens.add_argument("--marker-mm", type=float, default=0.0, help="of a charuco board's markers (4x4_50)")
    lens.add_argument("--out", type=Path, required=True, metavar="CAMERA.toml")
    lens.set_defaults(call=_lens)
    place = steps.add_parser("place", help="from a picture of tags that lie at known places")
    place.add_argument("picture", type=Path, metavar="PICTURE")
    place.add_argument(
        "--settings", type=Path, required=True, metavar="OVERHEAD.toml", help="has the [[floor]] tags"
    )
    known = place.add_mutually_exclusive_group(required=True)
    known.add_argument("--lens", type=Path, metavar="CAMERA.toml", help="what `lens` wrote")
    known.add_argument("--camera-height-m", type=float, help="above the floor, for a lens without distortion")
    place.add_argument("--out", type=Path, required=True, metavar="CAMERA.toml")
    place.set_defaults(call=_place)


def run(arguments: argparse.Namespace) -> None:
    arguments.call(arguments)


def _lens(arguments: argparse.Namespace) -> None:
    columns, _, rows = arguments.squares.partition("x")
    if not (columns.isdigit() and rows.isdigit() and min(int(columns), int(rows)) >= 3):
        raise UserError(f"--squares is {arguments.squares!r}; columns x rows are wanted, such as 10x7")
    board = Board(int(columns), int(rows), arguments.square_mm / 1e3, arguments.marker_mm / 1e3)
    lens = find_lens(pictures_of(arguments.pictures), board)
    _write(arguments.out, Calibration(lens))
    print(f"focal length {lens.focal_u_px:.1f} px; the board's corners miss by {lens.residual_px:.2f} px")


def _place(arguments: argparse.Namespace) -> None:
    settings, picture = load_settings(arguments.settings), read_picture(arguments.picture)
    places_m, pixels = _known_points(settings, picture)
    if arguments.lens:
        lens = Calibration.load(arguments.lens).lens
        if (lens.height, lens.width) != picture.shape:
            raise UserError(
                f"{arguments.picture} has {picture.shape[1]} x {picture.shape[0]} pixels, and the lens was "
                f"calibrated for {lens.width} x {lens.height}: use the camera at that size"
            )
    else:
        size = (picture.shape[1], picture.shape[0])
        lens = undistorted_lens(places_m, pixels, size, arguments.camera_height_m)
    view = view_from_known_points(lens, places_m, pixels)
    _write(arguments.out, Calibration.of_view(view))
    x_m, y_m, height_m = view.place_m
    print(f"the camera is at ({x_m:.3f}, {y_m:.3f}) m, {height_m:.3f} m above the floor; ", end="")
    print(f"the known corners miss by {view.residual_px:.2f} px")


def _known_points(settings: OverheadSettings, picture: npt.NDArray[np.uint8]) -> tuple[Floats, Floats]:
    """Corners of the floor's tags: where they are (n, 3) and where they are seen (n, 2)."""
    if not settings.floor:
        raise UserError("the settings have no [[floor]] tags: lay some at known places and name them there")
    poses = {tag.id: (tag.x_m, tag.y_m, tag.height_m, tag.theta_rad) for tag in settings.floor}
    seen = TagDetector(TagFamily(settings.family, poses)).find(picture)
    _refuse_twins(seen)
    if not seen:
        raise UserError(f"none of the floor's tags {sorted(poses)} is seen in the picture")
    places_m = corners_of_known_tags(poses, settings.floor_side_m)
    return np.concatenate([places_m[tag.id] for tag in seen]), np.concatenate([tag.corners for tag in seen])


def _refuse_twins(tags: list[Tag]) -> None:
    ids = [tag.id for tag in tags]
    twice = {tag for tag in ids if ids.count(tag) > 1}
    if twice:
        raise UserError(f"the floor's tags {sorted(twice)} are seen more than once: leave one of each")


def _write(path: Path, calibration: Calibration) -> None:
    with new_file(path) as file:
        file.write(calibration.as_toml().encode())
