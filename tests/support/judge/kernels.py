"""The ray tracer, compiled: the nearest thing on a ray, its light, and the pixels that need many rays.

A ray starts at `o` and runs along `d`, lengths are in units of d; a view is a camera's x, y, z and the
cosine and sine of its heading. All compiled functions stand in this one file, since numba's cache notices
changes of that file only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Real = float | Any
Whole = int | Any
Vector = tuple[Real, Real, Real] | Any
Colour = tuple[Real, Real, Real] | Any
Array = Any
Function = TypeVar("Function", bound=Callable[..., Any])

FAR = 1e9
NEAR = 1e-6  # a shadow's ray must not meet the surface that it starts from
SAMPLES = 16  # rays through a pixel that an edge may cross: one in each row and column of a 16 x 16 grid
STRIDE = 7  # prime to SAMPLES and near half: neighbours in x lie far apart in y

# Things are numbered: cylinders from 0, then boxes, then balls; and these.
FLOOR, BACKGROUND = -1, -2
# The image of a thing in the floor, added to its number.
MIRRORED = 1_000_000
# A pixel of the zone of the pins, which are thinner than a pixel: always sampled finely.
FINE = -3


def compiled(function: Function) -> Function:
    """Without reference counts, since nothing allocates; inlined, or calls would copy the scene's arrays."""
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": True}
    options |= {"_nrt": False, "forceinline": True}
    result: Function = njit(**options)(function)
    return result


@compiled
def cylinder(o: Vector, d: Vector, c: Any) -> tuple[Real, Whole]:
    """Where a ray meets an upright cylinder: distance (FAR if never), and 0 side, 1 top, -1 underside."""
    px, py = o[0] - c.x, o[1] - c.y
    a = d[0] * d[0] + d[1] * d[1]
    b = px * d[0] + py * d[1]
    discriminant = b * b - a * (px * px + py * py - c.radius * c.radius)
    if discriminant <= 0.0 or a < 1e-12:
        return FAR, 0
    root = math.sqrt(discriminant)
    enter, leave = (-b - root) / a, (root - b) / a
    z = o[2] + enter * d[2]
    if enter > NEAR and c.bottom <= z <= c.top:
        return enter, 0
    face = 1 if z > c.top else -1
    if face * d[2] >= 0.0:
        return FAR, 0
    t = ((c.top if face == 1 else c.bottom) - o[2]) / d[2]
    return (t if t > NEAR and enter <= t <= leave else FAR), face


@compiled
def slab(start: Real, step: Real, low: Real, high: Real) -> tuple[Real, Real]:
    """Where a coordinate that runs from `start` in steps enters and leaves an interval."""
    inverse = 1.0 / (step if abs(step) > 1e-12 else 1e-12)
    first, last = (low - start) * inverse, (high - start) * inverse
    return min(first, last), max(first, last)


@compiled
def box(o: Vector, d: Vector, b: Any) -> tuple[Real, Whole]:
    """Where a ray enters a box on the floor: distance (FAR if never), and the axis it crosses (0, 1, 2)."""
    px, py = o[0] - b.x, o[1] - b.y
    enter, leave = slab(b.cos * px + b.sin * py, b.cos * d[0] + b.sin * d[1], -b.half_length, b.half_length)
    enter_1, leave_1 = slab(b.cos * py - b.sin * px, b.cos * d[1] - b.sin * d[0], -b.half_width, b.half_width)
    enter_2, leave_2 = slab(o[2], d[2], 0.0, b.top)
    axis = 0
    if enter_1 > enter:
        enter, axis = enter_1, 1
    if enter_2 > enter:
        enter, axis = enter_2, 2
    return (enter if NEAR < enter <= min(leave, leave_1, leave_2) else FAR), axis


@compiled
def ball(o: Vector, d: Vector, b: Any) -> Real:
    """Distance at which a ray enters a ball, FAR if never."""
    p = (o[0] - b.x, o[1] - b.y, o[2] - b.z)
    a, half = dot(d, d), dot(p, d)
    discriminant = half * half - a * (dot(p, p) - b.radius * b.radius)
    enter = (-half - math.sqrt(max(discriminant, 0.0))) / a
    return enter if discriminant > 0.0 and enter > NEAR else FAR


@compiled
def dot(a: Vector, b: Vector) -> Real:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def meets_robot(o: Vector, d: Vector, bound: Any) -> Any:
    """Whether the ray's ground track crosses the circle around the robot."""
    px, py = o[0] - bound[0], o[1] - bound[1]
    b = px * d[0] + py * d[1]
    a, c = d[0] * d[0] + d[1] * d[1], px * px + py * py - bound[2] * bound[2]
    return b * b >= a * c and (b < 0.0 or c < 0.0)


@compiled
def nearest(o: Vector, d: Vector, world: Any) -> tuple[Real, Whole, Whole]:
    """The first thing that a ray meets: distance, number, face."""
    t, number, face = FAR, BACKGROUND, 0
    if d[2] < 0.0 and o[2] > 0.0:
        t, number = -o[2] / d[2], FLOOR
    robot = meets_robot(o, d, world.bound)
    cylinders, boxes = len(world.cylinders), len(world.boxes)
    for index in range(0 if robot else world.robot_cylinders, cylinders):
        hit, side = cylinder(o, d, world.cylinders[index])
        if hit < t:
            t, number, face = hit, index, side
    for index in range(boxes):
        hit, side = box(o, d, world.boxes[index])
        if hit < t:
            t, number, face = hit, cylinders + index, side
    for index in range(len(world.balls) if robot else 0):
        hit = ball(o, d, world.balls[index])
        if hit < t:
            t, number, face = hit, cylinders + boxes + index, 0
    return t, number, face


@compiled
def facing(p: Vector, d: Vector, number: Whole, face: Whole, world: Any) -> tuple[Whole, Vector]:
    """The surface and the outward normal at a point of a cylinder, box or ball."""
    cylinders, boxes = len(world.cylinders), len(world.boxes)
    if number < cylinders:
        c = world.cylinders[number]
        if face != 0:
            return c.surface, (0.0, 0.0, float(face))
        nx, ny = (p[0] - c.x) / c.radius, (p[1] - c.y) / c.radius
        ahead = nx * math.cos(c.theta) + ny * math.sin(c.theta) > math.cos(c.opening_rad)
        hole = ahead and c.opening_bottom <= p[2] <= c.opening_top
        return (c.opening_surface if hole else c.surface), (nx, ny, 0.0)
    if number < cylinders + boxes:
        b = world.boxes[number - cylinders]
        if face == 2:
            return b.surface, (0.0, 0.0, 1.0)
        nx, ny = (b.cos, b.sin) if face == 0 else (-b.sin, b.cos)
        sign = -1.0 if nx * d[0] + ny * d[1] > 0.0 else 1.0
        return b.surface, (sign * nx, sign * ny, 0.0)
    s = world.balls[number - cylinders - boxes]
    return s.surface, ((p[0] - s.x) / s.radius, (p[1] - s.y) / s.radius, (p[2] - s.z) / s.radius)


@compiled
def mixed(a: Colour, b: Colour, part: Real) -> Colour:
    rest = 1.0 - part
    return rest * a[0] + part * b[0], rest * a[1] + part * b[1], rest * a[2] + part * b[2]


@compiled
def pixel(image: Array, row: Whole, column: Whole) -> Colour:
    return image[row, column, 0], image[row, column, 1], image[row, column, 2]


@compiled
def texel(image: Array, row: Real, column: Real) -> Colour:
    """The colour between four pixels: columns go round, rows end at the borders."""
    rows, columns = image.shape[0], image.shape[1]
    row, base = min(max(row, 0.0), rows - 1.0), math.floor(column)
    top, left = int(row), int(base) % columns
    below, right = min(top + 1, rows - 1), (left + 1) % columns
    upper = mixed(pixel(image, top, left), pixel(image, top, right), column - base)
    lower = mixed(pixel(image, below, left), pixel(image, below, right), column - base)
    return mixed(upper, lower, row - top)


@compiled
def background(d: Vector, world: Any) -> Colour:
    """The panorama in a direction."""
    rows, columns = world.panorama.shape[0], world.panorama.shape[1]
    elevation = math.atan2(d[2], math.hypot(d[0], d[1]))
    turn = math.atan2(d[1], d[0]) / (2 * math.pi)
    return texel(world.panorama, (1 - elevation / world.panorama_top) * rows - 0.5, turn * columns - 0.5)


@compiled
def lit(p: Vector, normal: Vector, d: Vector, shininess: Real, world: Any) -> tuple[Real, Real]:
    """Lambert's law and Blinn's highlight of the lamp at a point, 0 in a shadow."""
    to_lamp = (world.lamp[0] - p[0], world.lamp[1] - p[1], world.lamp[2] - p[2])
    distance = math.sqrt(dot(to_lamp, to_lamp))
    cosine = dot(normal, to_lamp) / distance
    if cosine <= 0.0 or nearest(p, to_lamp, world)[0] < 1.0:
        return 0.0, 0.0
    power = world.lamp[3] / (distance * distance)
    scale = distance / math.sqrt(dot(d, d))
    half = (to_lamp[0] - scale * d[0], to_lamp[1] - scale * d[1], to_lamp[2] - scale * d[2])
    glint = dot(normal, half) / math.sqrt(dot(half, half))
    return power * cosine, power * max(glint, 0.0) ** shininess


@compiled
def floor(p: Vector, d: Vector, world: Any) -> Colour:
    """The light of the floor's tile at a point."""
    tiles = world.floor.shape[0] / world.floor_tile
    red, green, blue = texel(world.floor, (p[1] * tiles) % world.floor.shape[0], p[0] * tiles)
    light = world.lamp[4] + lit(p, (0.0, 0.0, 1.0), d, 1.0, world)[0]
    return red * light, green * light, blue * light


@compiled
def radiance(o: Vector, d: Vector, world: Any) -> tuple[Whole, Real, Real, Real]:
    """What a ray meets (a number for each face of each thing) and the light that comes back along it."""
    t, number, face = nearest(o, d, world)
    if number == BACKGROUND:
        red, green, blue = background(d, world)
        return number, red, green, blue
    p = (o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2])
    if number == FLOOR:
        red, green, blue = floor(p, d, world)
        return number, red, green, blue
    index, normal = facing(p, d, number, face, world)
    s = world.surfaces[index]
    diffuse, glint = lit(p, normal, d, s.shininess, world)
    light, shine = world.lamp[4] + diffuse, s.specular * glint
    return 3 * number + face, s.red * light + shine, s.green * light + shine, s.blue * light + shine


@compiled
def polished(o: Vector, d: Vector, world: Any) -> tuple[Whole, Real, Real, Real]:
    """Radiance, the floor with its mirror image by Schlick's approximation to Fresnel's law."""
    number, red, green, blue = radiance(o, d, world)
    if number != FLOOR or world.floor_gloss == 0.0:
        return number, red, green, blue
    t = -o[2] / d[2]
    p = (o[0] + t * d[0], o[1] + t * d[1], NEAR)
    behind, mirror_red, mirror_green, mirror_blue = radiance(p, (d[0], d[1], -d[2]), world)
    cosine = -d[2] / math.sqrt(dot(d, d))
    part = world.floor_gloss * (0.04 + 0.96 * (1.0 - cosine) ** 5)  # 4 % at right angles: polymers and glass
    red, green, blue = mixed((red, green, blue), (mirror_red, mirror_green, mirror_blue), part)
    return MIRRORED + behind, red, green, blue


@compiled
def direction(corners: Array, row: Whole, column: Whole, down: Real, right: Real, view: Any) -> Vector:
    """The direction through a place within a pixel, between those through its corners."""
    upper = mixed(pixel(corners, row, column), pixel(corners, row, column + 1), right)
    lower = mixed(pixel(corners, row + 1, column), pixel(corners, row + 1, column + 1), right)
    return turned(mixed(upper, lower, down), view)


@compiled
def turned(d: Vector, view: Any) -> Vector:
    """A direction forward, left, up of the camera in the arena's axes."""
    return view[3] * d[0] - view[4] * d[1], view[4] * d[0] + view[3] * d[1], d[2]


@compiled
def draw_middles(corners: Array, view: Any, world: Any, light: Array, numbers: Array) -> None:
    """One ray through the middle of every pixel."""
    o = (view[0], view[1], view[2])
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            d = direction(corners, row, column, 0.5, 0.5, view)
            number, red, green, blue = polished(o, d, world)
            light[row, column, 0], light[row, column, 1], light[row, column, 2] = red, green, blue
            pins = len(world.pins) > 0 and cylinder(o, d, world.pins[0])[0] < FAR
            numbers[row, column] = FINE if pins else number


@compiled
def is_edge(numbers: Array, row: Whole, column: Whole) -> Any:
    """Whether a pixel may show pins or has a neighbour that shows another thing."""
    here = numbers[row, column]
    if here == FINE:
        return True
    for r in range(max(row - 1, 0), min(row + 2, numbers.shape[0])):
        for c in range(max(column - 1, 0), min(column + 2, numbers.shape[1])):
            if numbers[r, c] != here:
                return True
    return False


@compiled
def draw_pixel(corners: Array, row: Whole, column: Whole, view: Any, world: Any, light: Array) -> None:
    """The mean of many rays through a pixel."""
    total_red, total_green, total_blue = 0.0, 0.0, 0.0
    for index in range(SAMPLES):
        down, right = (STRIDE * index % SAMPLES + 0.5) / SAMPLES, (index + 0.5) / SAMPLES
        d = direction(corners, row, column, down, right, view)
        _, red, green, blue = polished((view[0], view[1], view[2]), d, world)
        total_red, total_green, total_blue = total_red + red, total_green + green, total_blue + blue
    light[row, column, 0] = total_red / SAMPLES
    light[row, column, 1] = total_green / SAMPLES
    light[row, column, 2] = total_blue / SAMPLES


@compiled
def draw_edges(corners: Array, view: Any, world: Any, light: Array, numbers: Array) -> None:
    """Many rays through every pixel that an edge may cross."""
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            if is_edge(numbers, row, column):
                draw_pixel(corners, row, column, view, world, light)


@compiled
def count_shown(points: Array, view: Any, world: Any) -> Any:
    """How many points (n, 3), forward, left, up of the camera, nothing hides."""
    shown = 0
    for index in range(len(points)):
        d = turned((points[index, 0], points[index, 1], points[index, 2]), view)
        # The last percent of the way may meet the point's own surface.
        if nearest((view[0], view[1], view[2]), d, world)[0] > 0.99:
            shown += 1
    return shown
