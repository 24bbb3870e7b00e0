"""What is probably set wrongly when a tracking system's poses make no sense."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from statistics import median

from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose

FAR_OUT = 10.0
"""A unit that is too small by 1000 puts a robot hundreds of arenas away; a carried robot, never ten."""
SMALL_UNITS = ((1_000.0, "is it in millimetres?"), (10_000.0, "is it in units of 0.1 mm?"))
STEP_M = 0.02
"""A direction of motion is taken over 2 cm: at 1 mm of noise it is right within 0.1 rad."""
FEWEST_STEPS = 10
AGREES, DISAGREES = 0.9, 0.6
"""Lengths of the mean of unit vectors: a spread of 26 degrees, and one of 58."""
LEANS_RAD = 0.5
"""No robot that stands on a floor leans by 29 degrees."""
FLAT_M, HIGH_M = 0.03, 0.15
"""Heights on one floor differ by less than the first; places in an arena, by more than the second."""
TURNED_RAD = 0.35
"""A marker hat is put on straight within 20 degrees."""


def likely_mistake(pose: Pose, width_m: float, height_m: float) -> str:
    """A question about a pose that is outside the arena; "" if nothing suggests itself."""

    def inside(x_m: float, y_m: float) -> bool:
        return 0.0 <= x_m <= width_m and 0.0 <= y_m <= height_m

    if max(abs(pose.x_m), abs(pose.y_m)) > FAR_OUT * max(width_m, height_m):
        scaled = ((abs(pose.x_m) / factor, abs(pose.y_m) / factor, said) for factor, said in SMALL_UNITS)
        return next((said for x_m, y_m, said in scaled if inside(x_m, y_m)), "is the unit right?")
    mirrored = ((-pose.x_m, pose.y_m, "is x mirrored?"), (pose.x_m, -pose.y_m, "is y mirrored?"))
    return next((said for x_m, y_m, said in mirrored if inside(x_m, y_m)), "")


def likely_mistakes(poses: Sequence[TrackedPose], width_m: float, height_m: float) -> list[str]:
    """Every mistake that some seconds of poses suggest, each with its cure."""
    outside = [tracked.pose for tracked in poses if _is_out(tracked.pose, width_m, height_m)]
    questions = dict.fromkeys(likely_mistake(pose, width_m, height_m) for pose in outside)
    found = [f"unit_m, origin_m or axes: {question}" for question in questions if question]
    if any(abs(tracked.pose.theta_rad) > math.tau for tracked in poses):
        found.append("headings beyond a full turn: are they in degrees?")
    if _other_axis_is_up(poses):
        found.append('axes: y hardly changes and the height does: is y up? Then it is "x -z y"')
    tilts_rad = [tracked.tilt_rad for tracked in poses if tracked.tilt_rad is not None]
    if tilts_rad and median(tilts_rad) > LEANS_RAD:
        degrees = math.degrees(median(tilts_rad))
        found.append(
            f"robots lean by {degrees:.0f} degrees: is another axis up, or a rotation vector read as angles?"
        )
    return found + _heading_mistakes(poses)


def _is_out(pose: Pose, width_m: float, height_m: float) -> bool:
    return not (0.0 <= pose.x_m <= width_m and 0.0 <= pose.y_m <= height_m)


def _other_axis_is_up(poses: Sequence[TrackedPose]) -> bool:
    heights_m = [tracked.height_m for tracked in poses if tracked.height_m is not None]
    if len(heights_m) < len(poses) or not poses:
        return False
    y_m = [tracked.pose.y_m for tracked in poses]
    return max(y_m) - min(y_m) < FLAT_M and max(heights_m) - min(heights_m) > HIGH_M


def _heading_mistakes(poses: Sequence[TrackedPose]) -> list[str]:
    """Where robots face against where they go; both ways count alike, since robots can drive backwards."""
    steps = [step for robot in {tracked.robot for tracked in poses} for step in _steps(_of(robot, poses))]
    if len(steps) < FEWEST_STEPS:
        return []
    direct = _mean(2 * (motion_rad - heading_rad) for motion_rad, heading_rad in steps)
    mirrored = _mean(2 * (motion_rad + heading_rad) for motion_rad, heading_rad in steps)
    if abs(mirrored) > AGREES and abs(direct) < DISAGREES:
        return ["headings turn against the motion: is one axis mirrored?"]
    turn_rad = cmath.phase(direct) / 2
    if abs(direct) > AGREES and abs(turn_rad) > TURNED_RAD:
        degrees = math.degrees(turn_rad)
        return [f"robots drive {degrees:.0f} degrees off their heading: body_turn_rad = {turn_rad:.2f}?"]
    return []


def _of(robot: str, poses: Iterable[TrackedPose]) -> list[Pose]:
    return [tracked.pose for tracked in poses if tracked.robot == robot]


def _steps(poses: list[Pose]) -> list[tuple[float, float]]:
    """The direction of motion and the heading at each step of some centimetres."""
    kept = poses[:1]
    for pose in poses:
        if pose.distance_m(kept[-1]) >= STEP_M:
            kept.append(pose)
    return [
        (math.atan2(later.y_m - earlier.y_m, later.x_m - earlier.x_m), earlier.theta_rad)
        for earlier, later in pairwise(kept)
    ]


def _mean(angles_rad: Iterable[float]) -> complex:
    """The mean of unit vectors: its length says how far they agree."""
    vectors = [cmath.rect(1.0, angle_rad) for angle_rad in angles_rad]
    return sum(vectors) / len(vectors)
