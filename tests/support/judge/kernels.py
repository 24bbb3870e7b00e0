"""The ray tracer, compiled: nearest surface, its light, and the pixels that need many rays.

Every function follows one ray from `o` (ox, oy, oz) along `d`; lengths are in units of d. All compiled
functions stand in this one file, since numba's cache notices changes of that file only.
"""

from __future__ import annotations

import math
from typing import Any

import numba
from numba import njit

Real = float | Any
Whole = int | Any
Array = Any

FAR = 1e9
NEAR = 1e-6  # a shadow's ray must not meet the surface that it starts from
SAMPLES = 16  # rays through a pixel that an edge may cross: one in each row and column of a 16 x 16 grid
STRIDE = 7  # prime to SAMPLES and near half: neighbours in x lie far apart in y

# Kinds of surfaces that are no primitive; primitives count up from 0.
BACKGROUND, FLOOR = -2, -1

compiled: Any = njit(cache=True, nogil=True, error_model="numpy", fastmath=True, _nrt=False)
inlined: Any = njit(cache=True, nogil=True, error_model="numpy", fastmath=True, _nrt=False, inline="always")


@compiled
def cylinder(ox: Real, oy: Real, oz: Real, dx: Real, dy: Real, dz: Real, c: Any) -> tuple[Real, Whole]:
    """Where a ray meets an upright cylinder: distance (FAR if never), and 0 side, 1 top, -1 underside."""
    px, py = ox - c.x, oy - c.y
    a = dx * dx + dy * dy
    b = px * dx + py * dy
    discriminant = b * b - a * (px * px + py * py - c.radius * c.radius)
    if discriminant <= 0.0 or a < 1e-12:
        return FAR, 0
    root = math.sqrt(discriminant)
    enter, leave = (-b - root) / a, (root - b) / a
    z = oz + enter * dz
    if enter > NEAR and c.bottom <= z <= c.top:
        return enter, 0
    if z > c.top and dz < 0.0:
        t, cap = (c.top - oz) / dz, 1
    elif z < c.bottom and dz > 0.0:
        t, cap = (c.bottom - oz) / dz, -1
    else:
        return FAR, 0
    if t > NEAR and enter <= t <= leave:
        return t, cap
    return FAR, 0


@compiled
def box(ox: Real, oy: Real, oz: Real, dx: Real, dy: Real, dz: Real, b: Any) -> tuple[Real, Whole]:
    """Where a ray enters a box on the floor: distance (FAR if never), and the axis it crosses (0, 1, 2)."""
    px, py = ox - b.x, oy - b.y
    along, across = b.cos * px + b.sin * py, b.cos * py - b.sin * px
    d_along, d_across = b.cos * dx + b.sin * dy, b.cos * dy - b.sin * dx
    enter, leave, axis = -FAR, FAR, 0
    for index in range(3):
        if index == 0:
            start, step, low, high = along, d_along, -b.half_length, b.half_length
        elif index == 1:
            start, step, low, high = across, d_across, -b.half_width, b.half_width
        else:
            start, step, low, high = oz, dz, 0.0, b.top
        if abs(step) < 1e-12:
            if start < low or start > high:
                return FAR, 0
            continue
        first, last = (low - start) / step, (high - start) / step
        if first > last:
            first, last = last, first
        if first > enter:
            enter, axis = first, index
        leave = min(leave, last)
    if enter > NEAR and enter <= leave:
        return enter, axis
    return FAR, 0


@compiled
def ball(ox: Real, oy: Real, oz: Real, dx: Real, dy: Real, dz: Real, b: Any) -> Real:
    """Distance at which a ray enters a ball, FAR if never."""
    px, py, pz = ox - b.x, oy - b.y, oz - b.z
    a = dx * dx + dy * dy + dz * dz
    half = px * dx + py * dy + pz * dz
    discriminant = half * half - a * (px * px + py * py + pz * pz - b.radius * b.radius)
    if discriminant <= 0.0:
        return FAR
    enter = (-half - math.sqrt(discriminant)) / a
    return enter if enter > NEAR else FAR


@compiled
def meets_robot(ox: Real, oy: Real, dx: Real, dy: Real, bound: Any) -> bool:
    """Whether the ray's ground track crosses the circle around the robot."""
    px, py = ox - bound[0], oy - bound[1]
    b = px * dx + py * dy
    a, c = dx * dx + dy * dy, px * px + py * py - bound[2] * bound[2]
    return b * b >= a * c and (b < 0.0 or c < 0.0)


@compiled
def nearest(ox: Real, oy: Real, oz: Real, dx: Real, dy: Real, dz: Real, world: Any) -> tuple[Real, Whole, Whole]:
    """The first thing that a ray meets: distance, its number (the kinds above, or a primitive), its face."""
    t, number, face = FAR, BACKGROUND, 0
    if dz < 0.0 and oz > 0.0:
        t, number = -oz / dz, FLOOR
    robot = meets_robot(ox, oy, dx, dy, world.bound)
    cylinders = len(world.cylinders)
    for index in range(0 if robot else world.robot_cylinders, cylinders):
        hit, side = cylinder(ox, oy, oz, dx, dy, dz, world.cylinders[index])
        if hit < t:
            t, number, face = hit, index, side
    for index in range(len(world.boxes)):
        hit, side = box(ox, oy, oz, dx, dy, dz, world.boxes[index])
        if hit < t:
            t, number, face = hit, cylinders + index, side
    if robot:
        for index in range(len(world.balls)):
            hit = ball(ox, oy, oz, dx, dy, dz, world.balls[index])
            if hit < t:
                t, number, face = hit, cylinders + len(world.boxes) + index, 0
    return t, number, face


@compiled
def facing(
    x: Real, y: Real, z: Real, dx: Real, dy: Real, number: Whole, face: Whole, world: Any
) -> tuple[Whole, Real, Real, Real]:
    """The surface and the outward normal at a point of a primitive."""
    cylinders, boxes = len(world.cylinders), len(world.boxes)
    if number < cylinders:
        c = world.cylinders[number]
        if face != 0:
            return c.surface, 0.0, 0.0, float(face)
        nx, ny = (x - c.x) / c.radius, (y - c.y) / c.radius
        surface = c.surface
        hole = c.opening_bottom <= z <= c.opening_top
        if hole and nx * math.cos(c.theta) + ny * math.sin(c.theta) > math.cos(c.opening_rad):
            surface = c.opening_surface
        return surface, nx, ny, 0.0
    if number < cylinders + boxes:
        b = world.boxes[number - cylinders]
        if face == 2:
            return b.surface, 0.0, 0.0, 1.0
        nx, ny = (b.cos, b.sin) if face == 0 else (-b.sin, b.cos)
        sign = -1.0 if nx * dx + ny * dy > 0.0 else 1.0
        return b.surface, sign * nx, sign * ny, 0.0
    s = world.balls[number - cylinders - boxes]
    return s.surface, (x - s.x) / s.radius, (y - s.y) / s.radius, (z - s.z) / s.radius


@compiled
def texel(image: Array, row: Real, column: Real) -> tuple[Real, Real, Real]:
    """The colour between four pixels: columns go round, rows end at the borders."""
    rows, columns = image.shape[0], image.shape[1]
    row = min(max(row, 0.0), rows - 1.0)
    top, left = int(row), math.floor(column)
    down, right = row - top, column - left
    below, left = min(top + 1, rows - 1), int(left) % columns
    beside = (left + 1) % columns
    a, b = (1 - down) * (1 - right), (1 - down) * right
    c, d = down * (1 - right), down * right
    red = a * image[top, left, 0] + b * image[top, beside, 0] + c * image[below, left, 0] + d * image[below, beside, 0]
    green = a * image[top, left, 1] + b * image[top, beside, 1] + c * image[below, left, 1] + d * image[below, beside, 1]
    blue = a * image[top, left, 2] + b * image[top, beside, 2] + c * image[below, left, 2] + d * image[below, beside, 2]
    return red, green, blue


@compiled
def background(dx: Real, dy: Real, dz: Real, world: Any) -> tuple[Real, Real, Real]:
    """The panorama in a direction."""
    rows, columns = world.panorama.shape[0], world.panorama.shape[1]
    elevation = math.atan2(dz, math.hypot(dx, dy))
    turn = math.atan2(dy, dx) / (2 * math.pi)
    return texel(world.panorama, (1 - elevation / world.panorama_top) * rows - 0.5, turn * columns)


@compiled
def lit(
    x: Real, y: Real, z: Real, nx: Real, ny: Real, nz: Real, dx: Real, dy: Real, dz: Real, shininess: Real, world: Any
) -> tuple[Real, Real]:
    """Lambert's law and Blinn's highlight of the lamp at a point, 0 in a shadow."""
    lx, ly, lz = world.lamp[0] - x, world.lamp[1] - y, world.lamp[2] - z
    distance = math.sqrt(lx * lx + ly * ly + lz * lz)
    cosine = (nx * lx + ny * ly + nz * lz) / distance
    if cosine <= 0.0 or nearest(x, y, z, lx, ly, lz, world)[0] < 1.0:
        return 0.0, 0.0
    power = world.lamp[3] / (distance * distance)
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    hx, hy, hz = lx / distance - dx / length, ly / distance - dy / length, lz / distance - dz / length
    half = (nx * hx + ny * hy + nz * hz) / math.sqrt(hx * hx + hy * hy + hz * hz)
    return power * cosine, power * max(half, 0.0) ** shininess


@compiled
def radiance(
    ox: Real, oy: Real, oz: Real, dx: Real, dy: Real, dz: Real, world: Any
) -> tuple[Whole, Real, Real, Real]:
    """What a ray meets (a number for each face of each thing) and the light that comes back along it."""
    t, number, face = nearest(ox, oy, oz, dx, dy, dz, world)
    if number == BACKGROUND:
        red, green, blue = background(dx, dy, dz, world)
        return number, red, green, blue
    x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
    if number == FLOOR:
        tiles = world.floor.shape[0] / world.floor_tile
        red, green, blue = texel(world.floor, (y * tiles) % world.floor.shape[0], x * tiles)
        light = world.lamp[4] + lit(x, y, z, 0.0, 0.0, 1.0, dx, dy, dz, 1.0, world)[0]
        return number, red * light, green * light, blue * light
    index, nx, ny, nz = facing(x, y, z, dx, dy, number, face, world)
    surface = world.surfaces[index]
    diffuse, glint = lit(x, y, z, nx, ny, nz, dx, dy, dz, surface.shininess, world)
    light, shine = world.lamp[4] + diffuse, surface.specular * glint
    return 3 * number + face, surface.red * light + shine, surface.green * light + shine, surface.blue * light + shine


@inlined
def through(corners: Array, row: Whole, column: Whole, down: Real, right: Real, axis: Whole) -> Real:
    """One axis of the direction through a place within a pixel, between the pixel's corners."""
    upper = (1 - right) * corners[row, column, axis] + right * corners[row, column + 1, axis]
    lower = (1 - right) * corners[row + 1, column, axis] + right * corners[row + 1, column + 1, axis]
    return (1 - down) * upper + down * lower


@compiled
def sample(
    corners: Array, row: Whole, column: Whole, down: Real, right: Real, view: Any, world: Any
) -> tuple[Whole, Real, Real, Real]:
    """The light through a place within a pixel, for a camera at `view`: x, y, z, cosine and sine of its heading."""
    forward = through(corners, row, column, down, right, 0)
    left = through(corners, row, column, down, right, 1)
    up = through(corners, row, column, down, right, 2)
    dx, dy = view[3] * forward - view[4] * left, view[4] * forward + view[3] * left
    return radiance(view[0], view[1], view[2], dx, dy, up, world)


@compiled
def draw_middles(corners: Array, view: Any, world: Any, light: Array, numbers: Array) -> None:
    """One ray through the middle of every pixel."""
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            number, red, green, blue = sample(corners, row, column, 0.5, 0.5, view, world)
            light[row, column, 0], light[row, column, 1], light[row, column, 2] = red, green, blue
            numbers[row, column] = number


@compiled
def is_edge(numbers: Array, row: Whole, column: Whole, finest: Whole) -> bool:
    """Whether a pixel shows the robot or has a neighbour that shows another thing."""
    here = numbers[row, column]
    if 0 <= here < finest:
        return True
    for r in range(max(row - 1, 0), min(row + 2, numbers.shape[0])):
        for c in range(max(column - 1, 0), min(column + 2, numbers.shape[1])):
            if numbers[r, c] != here:
                return True
    return False


@compiled
def draw_edges(corners: Array, view: Any, world: Any, light: Array, numbers: Array) -> None:
    """The mean of many rays through every pixel that an edge may cross."""
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            if not is_edge(numbers, row, column, 3 * world.robot_cylinders):
                continue
            total_red, total_green, total_blue = 0.0, 0.0, 0.0
            for index in range(SAMPLES):
                down, right = (STRIDE * index % SAMPLES + 0.5) / SAMPLES, (index + 0.5) / SAMPLES
                _, red, green, blue = sample(corners, row, column, down, right, view, world)
                total_red, total_green, total_blue = total_red + red, total_green + green, total_blue + blue
            light[row, column, 0] = total_red / SAMPLES
            light[row, column, 1] = total_green / SAMPLES
            light[row, column, 2] = total_blue / SAMPLES
