"""Abstract demonstrations: what an observer in the corner would report of a robot that drives its moves.

No frame is rendered: range and bearing get noise of the size and the shape that rendered frames
show. Range noise is k d^2; half of its variance is a function of the place (a pixel's phase), so
that it does not average out while the robot stands still.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from robot_agent.imitation.positions import ObservedPosition, position_from_detection
from robot_agent.offline import demonstrations
from swarm.geometry import Compartment, Grid, Move, Pose, wrap_angle_rad

Rng = np.random.Generator
Place = tuple[float, float]

COMPARTMENT = Compartment(0.0, 0.0, Grid(10, 10), 0.12)
INSIDE_CORNER: Place = (1.16, 0.04)
"""The observer's place in the goal cell, as far into the corner as its body allows."""
OUTSIDE_CORNER: Place = (1.24, -0.04)
"""The observer's place just beyond the corner, out of the demonstrator's way."""
SPEED_LIMIT_M_S, ACCELERATION_M_S2, TURN_RAD_S = 0.10, 0.40, 3.0


@dataclass(frozen=True)
class Conditions:
    """How the demonstrator drives and how well it is seen."""

    range_noise_per_m: float = 0.015
    """k of the range's s.d. k d^2; 0.015 per metre is 1.5e-4 per centimetre."""
    frames_hz: float = 5.0
    bearing_sd_rad: float = math.radians(0.25)
    heading_bias_sd_rad: float = math.radians(0.7)
    stop_error_sd_m: float = 0.005
    pause_s: tuple[float, float] = (0.2, 0.5)
    rest_s: tuple[float, float] = (1.6, 2.0)
    speed_m_s: float = SPEED_LIMIT_M_S
    dropped: float = 0.03
    outliers: float = 0.01
    frozen_length_m: float = 0.02
    """Distance over which the frozen half of the range noise forgets itself."""
    observer: Place = INSIDE_CORNER
    camera_forward_m: float = 0.03


@dataclass(frozen=True)
class Demonstration:
    """The true moves and what was seen of them."""

    moves: tuple[Move, ...]
    positions: tuple[ObservedPosition, ...]
    expected_frames: int


@dataclass(frozen=True)
class Stretch:
    """A straight drive, or a stop if both ends are the same, that takes `duration_s`."""

    start: Place
    end: Place
    duration_s: float

    def at(self, since_s: float, speed_m_s: float) -> Place:
        """The place after `since_s`, with a trapezoid of speed."""
        length_m = math.dist(self.start, self.end)
        if length_m == 0.0:
            return self.start
        done = driven_m(length_m, since_s, speed_m_s) / length_m
        return tuple(a + done * (b - a) for a, b in zip(self.start, self.end, strict=True))  # type: ignore[return-value]


def drive_duration_s(length_m: float, speed_m_s: float) -> float:
    """Of a straight drive from stop to stop that reaches its speed limit if it is long enough."""
    ramp_m = speed_m_s**2 / ACCELERATION_M_S2
    if length_m < ramp_m:
        return 2 * math.sqrt(length_m / ACCELERATION_M_S2)
    return length_m / speed_m_s + speed_m_s / ACCELERATION_M_S2


def driven_m(length_m: float, since_s: float, speed_m_s: float) -> float:
    """The length driven after a time; symmetric about the middle of the drive."""
    duration_s = drive_duration_s(length_m, speed_m_s)
    if since_s > duration_s / 2:
        return length_m - driven_m(length_m, max(duration_s - since_s, 0.0), speed_m_s)
    ramp_s = speed_m_s / ACCELERATION_M_S2
    if since_s < ramp_s:
        return ACCELERATION_M_S2 * since_s**2 / 2
    return speed_m_s * (since_s - ramp_s / 2)


def random_moves(rng: Rng, count: int = 5, grid: Grid = COMPARTMENT.grid) -> tuple[int, tuple[Move, ...]]:
    """A start cell and moves that stay inside the grid and out of the goal cell."""
    return demonstrations.random_moves(rng, grid, count)


def expert_moves(rng: Rng, count: int = 5, grid: Grid = COMPARTMENT.grid) -> tuple[int, tuple[Move, ...]]:
    """Consecutive moves out of the expert's track along the diagonal, which ends before the goal cell."""
    first = int(rng.integers(grid.columns - 1 - count))
    return grid.state(first, first), (Move.SE,) * count


def demonstration(
    rng: Rng, start: int, moves: Sequence[Move], conditions: Conditions = Conditions()
) -> Demonstration:
    """Drive the moves from a rest to a rest, and see it."""
    route = track(rng, start, moves, conditions)
    positions, frames = watch(rng, route, conditions)
    return Demonstration(tuple(moves), positions, frames)


def track(rng: Rng, start: int, moves: Sequence[Move], conditions: Conditions) -> list[Stretch]:
    """A rest, then each move (turn, drive, pause), then a rest."""
    grid, state = COMPARTMENT.grid, start
    place = _stop(rng, state, conditions)
    stretches = [Stretch(place, place, rng.uniform(*conditions.rest_s))]
    heading_rad = moves[0].theta_rad if moves else 0.0
    for move in moves:
        entered = grid.neighbour(state, move)
        if entered is None:
            raise ValueError(f"{move.name} leaves the grid from state {state}; choose another start")
        goal = _stop(rng, entered, conditions)
        turn_s = abs(wrap_angle_rad(move.theta_rad - heading_rad)) / TURN_RAD_S
        stretches += [*_move(place, goal, turn_s, conditions), _pause(goal, rng.uniform(*conditions.pause_s))]
        state, place, heading_rad = entered, goal, move.theta_rad
    return [*stretches, _pause(place, rng.uniform(*conditions.rest_s))]


def drive_back(rng: Rng, route: list[Stretch], conditions: Conditions) -> list[Stretch]:
    """The one long drive from the end of a route back to the start cell, then a rest."""
    here, start = route[-1].end, _stop(rng, COMPARTMENT.grid.start, conditions)
    return [*_move(here, start, 1.0, conditions), _pause(start, rng.uniform(*conditions.rest_s))]


def _stop(rng: Rng, state: int, conditions: Conditions) -> Place:
    x_m, y_m = COMPARTMENT.centre(state) + rng.normal(0.0, conditions.stop_error_sd_m, 2)
    return float(x_m), float(y_m)


def _pause(place: Place, duration_s: float) -> Stretch:
    return Stretch(place, place, duration_s)


def _move(start: Place, goal: Place, turn_s: float, conditions: Conditions) -> list[Stretch]:
    drive_s = drive_duration_s(math.dist(start, goal), conditions.speed_m_s)
    return [_pause(start, turn_s), Stretch(start, goal, drive_s)]


def watch(
    rng: Rng, route: Sequence[Stretch], conditions: Conditions
) -> tuple[tuple[ObservedPosition, ...], int]:
    """What the observer reports of a route, and how many frames it took."""
    total_s = sum(stretch.duration_s for stretch in route)
    times_s = np.arange(rng.uniform(0.0, 1.0 / conditions.frames_hz), total_s, 1.0 / conditions.frames_hz)
    bias_rad = rng.normal(0.0, conditions.heading_bias_sd_rad)
    frozen = frozen_field(rng, conditions.frozen_length_m)
    seen = [
        _sighting(rng, place, bias_rad, frozen, conditions, round(t_s * 1e9))
        for t_s, place in zip(times_s, _places(route, times_s, conditions.speed_m_s), strict=True)
        if rng.random() >= conditions.dropped
    ]
    return tuple(seen), len(times_s)


def _places(route: Sequence[Stretch], times_s: np.ndarray, speed_m_s: float) -> list[Place]:
    ends_s = np.cumsum([stretch.duration_s for stretch in route])
    indices = np.searchsorted(ends_s, times_s)
    return [
        route[i].at(float(t_s - ends_s[i] + route[i].duration_s), speed_m_s)
        for i, t_s in zip(indices, times_s, strict=True)
    ]


def frozen_field(rng: Rng, length_m: float, waves: int = 32) -> Callable[[Place], float]:
    """A smooth random function of the place with unit variance: a sum of plane waves."""
    wave_numbers = rng.normal(0.0, 1.0 / length_m, (waves, 2))
    phases = rng.uniform(0.0, math.tau, waves)

    def value(place: Place) -> float:
        return float(math.sqrt(2.0 / waves) * np.cos(wave_numbers @ np.asarray(place) + phases).sum())

    return value


def _sighting(
    rng: Rng,
    place: Place,
    bias_rad: float,
    frozen: Callable[[Place], float],
    conditions: Conditions,
    t_ns: int,
) -> ObservedPosition:
    """One frame: the observer faces the demonstrator to within its dead band and measures."""
    x_m, y_m = conditions.observer
    facing_rad = math.atan2(place[1] - y_m, place[0] - x_m) + math.radians(rng.uniform(-4.0, 4.0))
    camera = Pose(x_m, y_m, facing_rad).compose(Pose(conditions.camera_forward_m, 0.0, 0.0))
    true = camera.relative(Pose(*place, 0.0))
    range_m, bearing_rad = math.hypot(true.x_m, true.y_m), math.atan2(true.y_m, true.x_m)
    error = math.sqrt(0.5) * (frozen(place) + rng.normal())
    seen_m = range_m + conditions.range_noise_per_m * range_m**2 * error
    seen_rad = bearing_rad + rng.normal(0.0, conditions.bearing_sd_rad)
    if rng.random() < conditions.outliers:
        seen_m, seen_rad = rng.uniform(0.1, 1.6), rng.uniform(-0.4, 0.4)
    return position_from_detection(
        Pose(x_m, y_m, facing_rad + bias_rad),
        conditions.camera_forward_m,
        max(seen_m, 0.05),
        seen_rad,
        max(conditions.range_noise_per_m * seen_m**2, 0.0005),
        conditions.bearing_sd_rad,
        t_ns,
        own_heading_sd_rad=0.0,
    )
