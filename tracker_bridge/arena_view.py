"""The arena and the robots in it, for eyes: in characters, and as a picture with the tracks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from swarm.config.experiment import ArenaSettings
from swarm.files import write_whole
from swarm.geometry import Pose

COLUMNS = 60
"""Characters from west to east; a character is about twice as high as it is wide."""
PIXELS_PER_M = 250
MARGIN_PX = 40
BLACK = (0, 0, 0)
COLOURS = ((200, 80, 20), (20, 120, 220), (40, 160, 40), (160, 40, 160), (0, 160, 200), (120, 120, 120))
"""Blue, green, red. Robots beyond the sixth take them again; their names stand beside them."""


def in_characters(tracks: Mapping[str, Sequence[Pose]], arena: ArenaSettings) -> str:
    """Each robot's name, beginning where the robot is; those outside the walls are left out."""
    rows = max(1, round(COLUMNS * arena.height_m / arena.width_m / 2))
    cells = [[" "] * COLUMNS for _ in range(rows)]
    for robot, track in tracks.items():
        pose = track[-1]
        column = int(pose.x_m / arena.width_m * COLUMNS)
        row = int((1 - pose.y_m / arena.height_m) * rows)
        if 0 <= column < COLUMNS and 0 <= row < rows:
            name = robot[: COLUMNS - column]
            cells[row][column : column + len(name)] = name
    wall = "+" + "-" * COLUMNS + "+"
    return "\n".join([wall, *("|" + "".join(row) + "|" for row in cells), wall])


def write_picture(path: Path, tracks: Mapping[str, Sequence[Pose]], arena: ArenaSettings) -> None:
    """A PNG of the arena, north up, with every robot's track and its name at the end."""
    import cv2
    import numpy as np

    height_px, width_px = (round(side_m * PIXELS_PER_M) for side_m in (arena.height_m, arena.width_m))
    picture = np.full((height_px + 2 * MARGIN_PX, width_px + 2 * MARGIN_PX, 3), 255, np.uint8)
    south_west, north_east = _pixels([Pose(0, 0, 0), Pose(arena.width_m, arena.height_m, 0)], arena)
    cv2.rectangle(picture, south_west, north_east, BLACK, 2)
    for number, (robot, track) in enumerate(tracks.items()):
        colour = COLOURS[number % len(COLOURS)]
        pixels = _pixels(track, arena)
        cv2.polylines(picture, [np.array(pixels, np.int32)], False, colour, 2, cv2.LINE_AA)
        cv2.putText(picture, robot, pixels[-1], cv2.FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv2.LINE_AA)
    _, encoded = cv2.imencode(".png", picture)
    write_whole(path, lambda temporary: temporary.write_bytes(encoded.tobytes()))


def _pixels(track: Iterable[Pose], arena: ArenaSettings) -> list[tuple[int, int]]:
    return [
        (
            MARGIN_PX + round(pose.x_m * PIXELS_PER_M),
            MARGIN_PX + round((arena.height_m - pose.y_m) * PIXELS_PER_M),
        )
        for pose in track
    ]
