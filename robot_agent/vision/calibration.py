"""Learns a demonstrator's colours from frames of it, wherever it stands in view.

Every hue is tried: the demonstrator's is the one with which something of a skirt's shape is seen in most
frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Colour, Demonstrator, Hat, Skirt
from robot_agent.vision.detector import Detection, Detector
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import Words, frame_words, word_colours
from robot_agent.vision.skirt_colour import TURNS, opponent
from robot_agent.vision.white_balance import WhiteBalance
from swarm.config.experiment import CopyProfile
from swarm.errors import UserError

HUES = 24
"""Tried first; neighbours are 0.26 rad apart, and a first look allows 0.2 rad to either side."""
FIRST_TOLERANCE_RAD = 0.2
FIRST_SATURATION = 0.5
"""Chosen: of a first look; half of it, the least that counts as coloured, is above any wall's."""
FIRST_LIGHTS = (0.9, 0.45)
"""Of a wall's; a bright skirt, and a dark one that is still brighter than an e-puck's boards."""
MIN_SATURATION = 0.15
"""Chosen: a skirt paler than this cannot be told from a white wall whose light is known to 5 %."""
HUE_TOLERANCE_RAD = (0.14, 0.22)
"""Least and most; chosen: neighbours in the rainbow (red and orange) are 0.5 rad apart."""
HUE_DEVIATIONS = 4.0
"""Chosen: of the skirt's own pixels, all but a few in 100,000 if they spread normally."""
ENOUGH_PART = 0.5
"""Of the frames; in fewer, what was found may be something else."""
MIDDLE_PART = 0.5
"""Of the skirt's width and height: there no blur reaches."""
ROWS_ABOVE = 4
"""Chosen: rows above the skirt, less the one that blur mixes; the boards fill them up to 150 cm."""


@dataclass(frozen=True)
class Calibration:
    """What was learnt, and how good it is: in how many of the frames it then sees the demonstrator."""

    demonstrator: Demonstrator
    frames: int
    seen: int
    pitch_deg: float
    roll_deg: float
    range_sd_part: float
    """The median standard deviation of the range, in parts of the range."""


def learn_demonstrator(frames: Sequence[Frame], model: CameraModel, skirt: Skirt) -> Calibration:
    """The colours of the skirt (`skirt` tells its size and name), of what is above it, and of the light.

    UserError if there is no frame, one of another size than the model's, or no skirt in half of the frames.
    """
    _check(frames, model)
    light = (word_colours() ** model.gamma).astype(np.float32)
    white = _white(frames, model, light)
    guess, looks = _best_guess(frames, model, skirt, white)
    if len(looks) < ENOUGH_PART * len(frames):
        raise UserError(
            f"nothing of a skirt's shape and of one colour is in {len(frames) - len(looks)} of "
            f"{len(frames)} frames: {_ADVICE}"
        )
    learnt = _learnt(looks, model, guess, white, light)
    found, detector = _looks(frames, model, learnt)
    parts = [seen.range_sd_m / seen.range_m for _, seen in found] or [1.0]
    tilt = np.degrees([detector.tilt.pitch_rad, detector.tilt.roll_rad])
    pitch_deg, roll_deg = (float(angle) for angle in tilt)
    return Calibration(learnt, len(frames), len(found), pitch_deg, roll_deg, float(np.median(parts)))


_ADVICE = (
    "put the robot with the skirt 20 to 100 cm before the camera, before a white wall, in good light, "
    "with its whole skirt in view, and check the skirt's size in the file"
)


def _check(frames: Sequence[Frame], model: CameraModel) -> None:
    if not frames:
        raise UserError("no frame to learn the skirt's colour from: is the camera connected?")
    for frame in frames:
        if (frame.width, frame.height) != (model.width, model.height):
            raise UserError(
                f"a {frame.width} x {frame.height} frame does not fit the camera's calibration for "
                f"{model.width} x {model.height}: use the calibration file of that size"
            )


def _white(frames: Sequence[Frame], model: CameraModel, light: NDArray[np.float32]) -> Colour:
    balance = WhiteBalance(model, light, (1.0, 1.0, 1.0))
    whites = [balance.follow(frame_words(frame)) for frame in frames]
    return _colour(np.median(whites, axis=0))


def _best_guess(
    frames: Sequence[Frame], model: CameraModel, skirt: Skirt, white: Colour
) -> tuple[Skirt, list[Look]]:
    """The colour with which a skirt is seen in most frames, and where it is seen."""
    colours = [_pure(number, light) for number in range(HUES) for light in FIRST_LIGHTS]
    guesses = [replace(skirt, colour=colour, hue_tolerance_rad=FIRST_TOLERANCE_RAD) for colour in colours]
    looks = [_looks(frames, model, Demonstrator(guess, white=white))[0] for guess in guesses]
    best = max(range(len(guesses)), key=lambda number: len(looks[number]))
    return guesses[best], looks[best]


def _pure(number: int, light: float) -> Colour:
    """A colour of one of the hues, of the saturation of a first look."""
    turned = np.exp(2j * np.pi * number / HUES) * np.conj(TURNS)
    parts = np.maximum(1 + 2 * FIRST_SATURATION * turned.real, 0.0)
    return _colour(light * parts / parts.max())


Look = tuple[Words, Detection]


def _looks(
    frames: Sequence[Frame], model: CameraModel, demonstrator: Demonstrator
) -> tuple[list[Look], Detector]:
    """The frames in which one demonstrator is seen whole; each by itself, since it may have been carried."""
    detector = Detector(CopyProfile.BEST, model, demonstrator)
    found = []
    for frame in frames:
        detector.reset()
        seen = detector.look(frame)
        if isinstance(seen, Detection) and not seen.cut_off:
            found.append((frame_words(frame), seen))
    return found, detector


def _learnt(
    looks: list[Look], model: CameraModel, skirt: Skirt, white: Colour, light: NDArray[np.float32]
) -> Demonstrator:
    """The colours where the skirt and what is above it were seen."""
    middles = np.concatenate([light[_middle(look, model, skirt)] for look in looks]) / white
    colour = np.median(middles, axis=0)
    around = opponent(middles, np.ones(3))
    middle = complex(opponent(colour[np.newaxis], np.ones(3))[0])
    if abs(middle) < MIN_SATURATION:
        raise UserError(f"what has a skirt's shape has no colour of its own: {_ADVICE}")
    spread_rad = float(np.std(np.angle(around / middle)))
    tolerance_rad = round(float(np.clip(HUE_DEVIATIONS * spread_rad, *HUE_TOLERANCE_RAD)), 3)
    nearest = sorted(looks, key=lambda look: look[1].range_m)[: (len(looks) + 1) // 2]
    above = np.median([_above(look, model, skirt, light, white) for look in nearest], axis=0)
    learnt = replace(skirt, colour=_colour(colour), hue_tolerance_rad=tolerance_rad)
    return Demonstrator(learnt, Hat(_colour(above)), white)


def _half_height_px(seen: Detection, model: CameraModel, skirt: Skirt) -> float:
    return model.focal_px * skirt.height_m / (seen.range_m - skirt.radius_m) / 2


def _middle_columns(seen: Detection, part: float) -> slice:
    """The part of the skirt's width around its middle."""
    assert seen.left_px is not None
    assert seen.right_px is not None
    middle_px, half_px = (seen.left_px + seen.right_px) / 2, (seen.right_px - seen.left_px) / 2 * part
    return slice(round(middle_px - half_px), round(middle_px + half_px) + 1)


def _middle(look: Look, model: CameraModel, skirt: Skirt) -> Words:
    words, seen = look
    half_px = MIDDLE_PART * _half_height_px(seen, model, skirt)
    rows = slice(max(0, round(seen.row_px - half_px)), max(1, round(seen.row_px + half_px)))
    return words[rows, _middle_columns(seen, MIDDLE_PART)].ravel()


def _above(
    look: Look, model: CameraModel, skirt: Skirt, light: NDArray[np.float32], white: Colour
) -> NDArray[np.float64]:
    """The colour of the row above the skirt that is least like the wall."""
    words, seen = look
    top = seen.row_px - _half_height_px(seen, model, skirt)
    first, last = max(0, round(top) - ROWS_ABOVE), max(1, round(top) - 1)
    strip = light[words[first:last, _middle_columns(seen, MIDDLE_PART)]] / white
    rows = np.median(strip, axis=1)
    return np.asarray(rows[int(np.argmin(rows.min(axis=1)))])


def _colour(light: NDArray[np.floating]) -> Colour:
    red, green, blue = (round(float(part), 4) for part in light)
    return red, green, blue
