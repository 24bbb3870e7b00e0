"""The compiled loops of the simulated camera: rays to light, light to sensor levels, levels to bytes.

Needs numba (the `lab` extra); imported by the simulated camera alone, when one is made.

The camera is level, so a vertical edge stays vertical before the lens bends it. Light is therefore
painted column by column into a "fine" image without distortion, shape (3, columns, rows), with two
columns a pixel; the lens and the shutter are then applied as one sampling of that image.

Two packed arguments: `camera` is (x_m, y_m, cos heading, sin heading, height_m); `raster` is (slope to
the right of the first column's left side, slope of a column, slope upwards of the first row's top, slope
of a row).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from numpy.typing import NDArray

from swarm.compilation import compiled

Array: TypeAlias = NDArray[Any]
Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def kernel(function: Kernel) -> Kernel:
    """Divisions by zero give what numpy says, without a test for each."""
    return compiled(function, error_model="numpy")


@kernel
def fill_span(
    fine: Array, column: int, top: float, bottom: float, red: float, green: float, blue: float, alpha: float
) -> None:
    """Blend a colour over rows top..bottom (fractions allowed, row r covers r..r+1) of a fine column."""
    rows = fine.shape[2]
    if bottom <= 0 or top >= rows or bottom <= top:
        return
    top, bottom = max(top, 0.0), min(bottom, float(rows))
    first, last = int(top), min(int(bottom), rows - 1)
    for row in range(first, last + 1):
        cover = alpha * (min(bottom, row + 1.0) - max(top, float(row)))
        fine[0, column, row] += cover * (red - fine[0, column, row])
        fine[1, column, row] += cover * (green - fine[1, column, row])
        fine[2, column, row] += cover * (blue - fine[2, column, row])


@kernel
def wall_ahead(camera: Array, right: float, rooms: Array) -> tuple[float, bool]:
    """(depth, whether it runs north-south) of the nearest wall that a ray meets from inside its room."""
    ahead_x = camera[2] + right * camera[3]
    ahead_y = camera[3] - right * camera[2]
    nearest, north_south = 1e3, False
    for room in range(rooms.shape[0]):
        west, east = (rooms[room, 0] - camera[0]) / ahead_x, (rooms[room, 2] - camera[0]) / ahead_x
        south, north = (rooms[room, 1] - camera[1]) / ahead_y, (rooms[room, 3] - camera[1]) / ahead_y
        leave_x, leave_y = max(west, east), max(south, north)
        enter, leave = max(min(west, east), min(south, north)), min(leave_x, leave_y)
        if leave > max(enter, 0.001) and leave < nearest:
            nearest, north_south = leave, leave_x < leave_y
    return nearest, north_south


@kernel
def paint_background(
    fine: Array, column: int, rows: int, camera: Array, right: float, raster: Array, panorama: Array
) -> None:
    """The laboratory above the walls: a blurred panorama, shape (3, bearings, elevations)."""
    bearing = math.atan2(camera[3] - right * camera[2], camera[2] + right * camera[3])
    across = int((bearing / math.tau + 0.5) * panorama.shape[1]) % panorama.shape[1]
    for row in range(rows):
        up = raster[2] - (row + 0.5) * raster[3]
        level = min(max(int(up * 100), 0), panorama.shape[2] - 1)
        for channel in range(3):
            fine[channel, column, row] = panorama[channel, across, level]


@kernel
def paint_floor(
    fine: Array,
    column: int,
    first: int,
    camera: Array,
    right: float,
    raster: Array,
    floor: Array,
    texture: Array,
) -> None:
    """The floor from a row to the bottom, with a texture that tiles in steps of 2 mm."""
    size = texture.shape[0]
    ahead_x = (camera[2] + right * camera[3]) * 500
    ahead_y = (camera[3] - right * camera[2]) * 500
    for row in range(first, fine.shape[2]):
        depth = camera[4] / max((row + 0.5) * raster[3] - raster[2], 1e-3)
        east = int(camera[0] * 500 + depth * ahead_x + 1e6) % size
        north = int(camera[1] * 500 + depth * ahead_y + 1e6) % size
        grain = texture[east, north]
        for channel in range(3):
            fine[channel, column, row] = floor[channel] * grain


@kernel
def paint_room(
    fine: Array,
    walls_m: Array,
    camera: Array,
    raster: Array,
    rooms: Array,
    wall_height_m: float,
    wall: Array,
    floor: Array,
    texture: Array,
    stains: Array,
    panorama: Array,
) -> None:
    """Everything that does not move; `walls_m` gets the depth of the wall in each column."""
    for column in range(fine.shape[1]):
        right = raster[0] + (column + 0.5) * raster[1]
        depth, north_south = wall_ahead(camera, right, rooms)
        walls_m[column] = depth
        top = (raster[2] - (wall_height_m - camera[4]) / depth) / raster[3]
        base = (raster[2] + camera[4] / depth) / raster[3]
        paint_background(
            fine, column, min(max(int(top) + 1, 0), fine.shape[2]), camera, right, raster, panorama
        )
        paint_floor(
            fine, column, min(max(int(base), 0), fine.shape[2]), camera, right, raster, floor, texture
        )
        if north_south:
            along, shade = camera[1] + depth * (camera[3] - right * camera[2]), 0.90
        else:
            along, shade = camera[0] + depth * (camera[2] + right * camera[3]), 1.0
        shade *= stains[int(abs(along) * 200) % stains.shape[0]]
        fill_span(fine, column, top, base, wall[0] * shade, wall[1] * shade, wall[2] * shade, 1.0)


@kernel
def paint_shadow(
    fine: Array,
    walls_m: Array,
    camera: Array,
    raster: Array,
    ahead_m: float,
    right_m: float,
    radius_m: float,
) -> None:
    """The dark rim on the floor around a cylinder's foot."""
    reach = radius_m + 0.03
    if ahead_m < reach + 0.01:
        return
    near, far = ahead_m - reach, ahead_m + reach
    left = (min((right_m - reach) / near, (right_m - reach) / far) - raster[0]) / raster[1]
    end = (max((right_m + reach) / near, (right_m + reach) / far) - raster[0]) / raster[1]
    top = (raster[2] + camera[4] / far) / raster[3]
    bottom = (raster[2] + camera[4] / near) / raster[3]
    for column in range(max(int(left), 0), min(int(end) + 1, fine.shape[1])):
        right = raster[0] + (column + 0.5) * raster[1]
        for row in range(max(int(top) + 1, 0), min(int(bottom) + 1, fine.shape[2])):
            depth = camera[4] / max((row + 0.5) * raster[3] - raster[2], 1e-3)
            if depth > walls_m[column]:
                continue
            away = math.hypot(depth - ahead_m, right * depth - right_m) - radius_m
            light = 1 - 0.6 * math.exp(-max(away, 0.0) / 0.009)
            for channel in range(3):
                fine[channel, column, row] *= light


@kernel
def paint_band(fine: Array, walls_m: Array, camera: Array, raster: Array, band: Array, lamp: Array) -> None:
    """A coloured cylinder; its side edges are ramps as long as it moves during the exposure.

    `band` is (ahead_m, right_m, radius_m, bottom_m, top_m, red, green, blue, shine, slope moved); `lamp` is
    the direction (ahead, right) that the light comes from.
    """
    ahead_m, right_m, radius_m, bottom_m, top_m = band[0], band[1], band[2], band[3], band[4]
    middle = math.atan2(right_m, ahead_m)
    half = math.asin(min(1.0, radius_m / math.hypot(ahead_m, right_m)))
    if abs(middle) + half > 1.4 and abs(middle) - half > 1.2:
        return
    left, end = math.tan(max(middle - half, -1.4)), math.tan(min(middle + half, 1.4))
    first, last = (left - raster[0]) / raster[1], (end - raster[0]) / raster[1]
    ramp = max(1.0, band[9] / raster[1])
    gap = ahead_m**2 + right_m**2 - radius_m**2
    for column in range(max(int(first - ramp), 0), min(int(last + ramp) + 1, fine.shape[1])):
        inside = min(max((column + 0.5 - first) / ramp + 0.5, 0.0), 1.0)
        alpha = inside - min(max((column + 0.5 - last) / ramp + 0.5, 0.0), 1.0)
        if alpha <= 0:
            continue
        right = min(max(raster[0] + (column + 0.5) * raster[1], left), end)
        square = 1 + right**2
        towards = ahead_m + right * right_m
        depth = (towards - math.sqrt(max(towards**2 - square * gap, 0.0))) / square
        if depth > walls_m[column]:
            continue
        normal_ahead, normal_right = (depth - ahead_m) / radius_m, (right * depth - right_m) / radius_m
        shade = 0.74 + 0.26 * max(normal_ahead * lamp[0] + normal_right * lamp[1], 0.0)
        half_ahead, half_right = lamp[0] - 1 / math.sqrt(square), lamp[1] - right / math.sqrt(square)
        length = max(math.hypot(half_ahead, half_right), 1e-6)
        mirrored = max((normal_ahead * half_ahead + normal_right * half_right) / length, 0.0)
        glint = band[8] * mirrored**40
        top = (raster[2] - (top_m - camera[4]) / depth) / raster[3]
        bottom = (raster[2] - (bottom_m - camera[4]) / depth) / raster[3]
        red, green, blue = band[5] * shade + glint, band[6] * shade + glint, band[7] * shade + glint
        fill_span(fine, column, top, bottom, red, green, blue, alpha)


@kernel
def paint_bands(fine: Array, walls_m: Array, camera: Array, raster: Array, bands: Array, lamp: Array) -> None:
    """All the cylinders that no wall hides, the farthest first, over the shadows of all."""
    for number in range(bands.shape[0]):
        if bands[number, 3] == 0.0:
            paint_shadow(fine, walls_m, camera, raster, bands[number, 0], bands[number, 1], bands[number, 2])
    for number in range(bands.shape[0]):
        paint_band(fine, walls_m, camera, raster, bands[number], lamp)


@kernel
def expose(
    fine: Array,
    map_x: Array,
    map_y: Array,
    gains: Array,
    skew: float,
    horizon_row: float,
    normals: Array,
    shot: float,
    read_squared: float,
    raw: Array,
) -> None:
    """Sample the light through the lens at each site of the Bayer mosaic (RGGB), with noise, into `raw`.

    `skew` is how many fine columns the view moves from one row to the next while the shutter rolls.
    `raw` has a rim of one site, filled by reflection.
    """
    height, width = map_x.shape
    last_column, last_row = fine.shape[1] - 1.001, fine.shape[2] - 1.001
    for row in range(height):
        moved = skew * (row - horizon_row)
        for column in range(width):
            channel = (row & 1) + (column & 1)
            x = min(max(map_x[row, column] + moved, 0.0), last_column)
            y = min(max(map_y[row, column], 0.0), last_row)
            left, top = int(x), int(y)
            x -= left
            y -= top
            light = (1 - x) * ((1 - y) * fine[channel, left, top] + y * fine[channel, left, top + 1])
            light += x * ((1 - y) * fine[channel, left + 1, top] + y * fine[channel, left + 1, top + 1])
            light *= gains[channel]
            level = light + math.sqrt(light * shot + read_squared) * normals[row * width + column]
            raw[row + 1, column + 1] = min(max(level, 0.0), 1.0)
    for column in range(1, width + 1):
        raw[0, column], raw[height + 1, column] = raw[2, column], raw[height - 1, column]
    for row in range(height + 2):
        raw[row, 0], raw[row, width + 1] = raw[row, 2], raw[row, width - 1]


@kernel
def demosaic(raw: Array, tone: Array, pixels: Array) -> None:
    """Bilinear demosaicing of an RGGB mosaic with a rim of one site, then the tone curve (bytes)."""
    height, width = pixels.shape[0], pixels.shape[1]
    steps = tone.size - 1
    for row in range(1, height + 1):
        for column in range(1, width + 1):
            here = raw[row, column]
            sides = (raw[row, column - 1] + raw[row, column + 1]) * 0.5
            ends = (raw[row - 1, column] + raw[row + 1, column]) * 0.5
            if (row + column) & 1:
                red, green, blue = (sides, here, ends) if row & 1 else (ends, here, sides)
            else:
                corners = raw[row - 1, column - 1] + raw[row - 1, column + 1]
                corners = (corners + raw[row + 1, column - 1] + raw[row + 1, column + 1]) * 0.25
                green = (sides + ends) * 0.5
                red, blue = (here, corners) if row & 1 else (corners, here)
            pixels[row - 1, column - 1, 0] = tone[int(red * steps)]
            pixels[row - 1, column - 1, 1] = tone[int(green * steps)]
            pixels[row - 1, column - 1, 2] = tone[int(blue * steps)]


@kernel
def pack_rgb565(pixels: Array, out: Array) -> None:
    """Two bytes a pixel, the high byte first."""
    for row in range(pixels.shape[0]):
        for column in range(pixels.shape[1]):
            red, green, blue = pixels[row, column, 0], pixels[row, column, 1], pixels[row, column, 2]
            out[row, column, 0] = (red & 0xF8) | (green >> 5)
            out[row, column, 1] = ((green & 0x1C) << 3) | (blue >> 3)


@kernel
def pack_yuyv(pixels: Array, out: Array) -> None:
    """ITU-R BT.601, studio range: Y0 U Y1 V for two pixels, the colour taken from their mean."""
    for row in range(pixels.shape[0]):
        for column in range(0, pixels.shape[1], 2):
            u, v = 128.5, 128.5
            for step in range(2):
                red = float(pixels[row, column + step, 0])
                green = float(pixels[row, column + step, 1])
                blue = float(pixels[row, column + step, 2])
                out[row, column + step, 0] = int(16.5 + 0.25679 * red + 0.50413 * green + 0.09791 * blue)
                u += 0.5 * (-0.14822 * red - 0.29099 * green + 0.43922 * blue)
                v += 0.5 * (0.43922 * red - 0.36779 * green - 0.07143 * blue)
            out[row, column, 1] = int(u)
            out[row, column + 1, 1] = int(v)
