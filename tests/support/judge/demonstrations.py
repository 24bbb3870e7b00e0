"""Views and five-move demonstrations drawn from a generator: what an observing robot sees, with the truth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import Compartment, Grid, Move, Pose, wrap_angle_rad
from tests.support.judge.conditions import Condition
from tests.support.judge.optics import Camera
from tests.support.judge.rendering import Truth, render, truth

COMPARTMENT = Compartment(west_m=0.0, south_m=0.0, grid=Grid(10, 10), cell_m=0.12)
NEAREST_M, FARTHEST_M = 0.4, 1.5
BORDER_M = 0.06  # an observer's middle stays a body's width from the walls
FRAMES_HZ = 5.0  # the paper, section 3.2
STAND_S = 1.5  # before the first move and after the last
SPEED_M_S = 0.05
TURN_RAD_S = 1.9  # wheels at that speed on an axle of 5.3 cm


@dataclass(frozen=True)
class Demonstration:
    """A robot's moves on the grid, its poses at the frames' times, and the pose of who watches."""

    moves: tuple[Move, ...]
    corners: tuple[Pose, ...]
    """Where the moves begin and end, one more than moves; headings are not meant."""
    times_s: NDArray[np.float64]
    poses: tuple[Pose, ...]
    observer: Pose


@dataclass(frozen=True)
class Frame:
    """One picture as the pipeline gets it, and what is true in it."""

    t_s: float
    data: bytes
    truth: Truth


def random_view(
    generator: np.random.Generator, camera: Camera, margin_rad: float = 0.12
) -> tuple[Pose, Pose]:
    """An observer and a robot in the compartment, 40 to 150 cm apart, evenly drawn by distance.

    The robot's axis is `margin_rad` inside the field of view; a negative margin lets borders cut it.
    """
    limit_rad = camera.horizontal_fov_rad / 2 - margin_rad
    bearing_rad = generator.uniform(-limit_rad, limit_rad)
    place, robot = _random_line(generator, generator.uniform(NEAREST_M, FARTHEST_M))
    heading = place._replace(theta_rad=wrap_angle_rad(place.theta_rad - bearing_rad))
    observer = heading.compose(Pose(-camera.forward_m, 0.0, 0.0))
    return observer, robot._replace(theta_rad=generator.uniform(-math.pi, math.pi))


def random_demonstration(
    generator: np.random.Generator, camera: Camera, moves: int = 5, margin_rad: float = 0.12
) -> Demonstration:
    """Moves between neighbouring cells' middles, all in view: 12 cm along an axis, 17 cm across a corner."""
    while True:
        path, corners = _random_path(generator, moves)
        for _ in range(50):  # most paths have a place to be seen from; give the others up
            observer = _facing(_random_pose(generator), corners)
            if all(_is_in_view(corner, observer, camera, margin_rad) for corner in corners):
                times_s, poses = _driven(path, corners)
                return Demonstration(path, corners, times_s, poses, observer)


def frames(
    demonstration: Demonstration, condition: Condition, camera: Camera, generator: np.random.Generator
) -> Iterator[Frame]:
    """The demonstration as filmed by a camera of the condition, in one random room."""
    room = condition.scene(demonstration.poses[0], generator)
    observer = demonstration.observer
    for t_s, pose in zip(demonstration.times_s, demonstration.poses, strict=True):
        scene = replace(room, robot=pose)
        data = render(scene, observer, camera, condition.sensor, generator)
        yield Frame(float(t_s), data, truth(scene, observer, camera))


def _random_pose(generator: np.random.Generator) -> Pose:
    x_m, y_m = generator.uniform(BORDER_M, COMPARTMENT.east_m - BORDER_M, 2).tolist()
    return Pose(x_m, y_m, generator.uniform(-math.pi, math.pi))


def _random_line(generator: np.random.Generator, length_m: float) -> tuple[Pose, Pose]:
    """Two places of the compartment that far apart, the first looking at the second."""
    room_m = COMPARTMENT.east_m - 2 * BORDER_M
    while True:
        turn_rad = generator.uniform(-math.pi, math.pi)
        line_m = length_m * np.array([math.cos(turn_rad), math.sin(turn_rad)])
        free_m = room_m - np.abs(line_m)
        if (free_m >= 0).all():  # a line longer than the side fits only along a diagonal
            break
    start_m = BORDER_M + np.maximum(-line_m, 0) + generator.uniform(0, 1, 2) * free_m
    start = Pose(float(start_m[0]), float(start_m[1]), turn_rad)
    return start, start.compose(Pose(length_m, 0.0, 0.0))


def _random_path(generator: np.random.Generator, moves: int) -> tuple[tuple[Move, ...], tuple[Pose, ...]]:
    state = int(generator.integers(COMPARTMENT.grid.states))
    path: list[Move] = []
    states = [state]
    while len(path) < moves:
        move = Move(int(generator.integers(len(Move))))
        entered = COMPARTMENT.grid.neighbour(states[-1], move)
        if entered is not None:
            path.append(move)
            states.append(entered)
    return tuple(path), tuple(Pose(*COMPARTMENT.centre(state), 0.0) for state in states)


def _facing(observer: Pose, corners: tuple[Pose, ...]) -> Pose:
    """The observer turned to the middle of the bearings, as someone puts it down to watch."""
    angles = np.array(
        [math.atan2(corner.y_m - observer.y_m, corner.x_m - observer.x_m) for corner in corners]
    )
    mean_rad = math.atan2(np.sin(angles).mean(), np.cos(angles).mean())
    return observer._replace(theta_rad=mean_rad)


def _is_in_view(corner: Pose, observer: Pose, camera: Camera, margin_rad: float) -> bool:
    seen = camera.pose(observer).relative(corner)
    bearing_rad, distance_m = math.atan2(seen.y_m, seen.x_m), math.hypot(seen.x_m, seen.y_m)
    limit_rad = camera.horizontal_fov_rad / 2 - margin_rad
    return abs(bearing_rad) <= limit_rad and NEAREST_M <= distance_m <= FARTHEST_M


def _driven(
    path: tuple[Move, ...], corners: tuple[Pose, ...]
) -> tuple[NDArray[np.float64], tuple[Pose, ...]]:
    """Times and poses of the frames while the robot stands, turns in place and drives, and stands again."""
    t_s, heading_rad = [0.0, STAND_S], [path[0].theta_rad] * 2
    x_m, y_m = [corners[0].x_m] * 2, [corners[0].y_m] * 2
    for move, start, end in zip(path, corners, corners[1:], strict=False):
        turn_rad = wrap_angle_rad(move.theta_rad - heading_rad[-1])
        t_s += [t_s[-1] + abs(turn_rad) / TURN_RAD_S]
        t_s += [t_s[-1] + start.distance_m(end) / SPEED_M_S]
        heading_rad += [heading_rad[-1] + turn_rad] * 2
        x_m, y_m = [*x_m, start.x_m, end.x_m], [*y_m, start.y_m, end.y_m]
    t_s, heading_rad = [*t_s, t_s[-1] + STAND_S], [*heading_rad, heading_rad[-1]]
    x_m, y_m = [*x_m, x_m[-1]], [*y_m, y_m[-1]]
    times_s = np.arange(0.0, t_s[-1], 1 / FRAMES_HZ)
    places = (np.interp(times_s, t_s, values) for values in (x_m, y_m, heading_rad))
    return times_s, tuple(Pose(*map(float, place)) for place in zip(*places, strict=True))
