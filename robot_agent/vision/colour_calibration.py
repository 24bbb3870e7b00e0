"""Learns a skirt's colour from a few frames of it.

The robot with the skirt stands 20 to 50 cm straight ahead of the camera in a white-walled compartment:
the middle of the image is then skirt, and the rest of the rows above the horizon mostly wall.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.colour_table import OTHER, PALE, SKIRT, ColourTable
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import Words, frame_words, word_colours
from swarm.errors import UserError

MIN_SATURATION = 0.15
"""Chosen: a skirt paler than this cannot be told from a white wall under a colour cast of 15 %."""
PART_OF_SATURATION = 0.45
"""Of the skirt's: lower than this, pixels of the wall beside it would count, unevenly, as skirt."""
HUE_TOLERANCE_RAD = (0.14, 0.22)
"""Least and most; chosen: neighbours in the rainbow (red and orange) are 0.5 rad apart."""
HUE_DEVIATIONS = 4.0
"""Chosen: of the skirt's own pixels, all but a few in 100,000 if they spread normally."""
PART_OF_LIGHT = 0.45
"""Of the skirt's median; chosen: darker pixels are of the shadow or of the body."""
PALE_SATURATION = 0.12
"""Chosen: just below the least saturation of a skirt, so that no colour is both."""
PALE_PART_OF_LIGHT = 0.3
"""Of the brightest wall; chosen: its shaded parts count as wall, the dark body does not."""


def learn_colour_table(frames: Sequence[Frame], model: CameraModel, skirt: str) -> ColourTable:
    """The table of the skirt (named `skirt`) in the middle of the frames.

    Raises UserError if there is no frame, one of another size than the model's, or the middle is not
    evenly of a colour.
    """
    if not frames:
        raise UserError("no frame to learn the skirt's colour from: is the camera connected?")
    for frame in frames:
        if (frame.width, frame.height) != (model.width, model.height):
            raise UserError(
                f"a {frame.width} x {frame.height} frame does not fit the camera's calibration for "
                f"{model.width} x {model.height}: use the calibration file of that size"
            )
    words = [frame_words(frame) for frame in frames]
    colours = word_colours() ** model.gamma
    seeds = colours[np.concatenate([_middle(image, model).ravel() for image in words])]
    walls = colours[np.concatenate([_beside(image, model).ravel() for image in words])]
    white = _white(walls)
    kinds = _kinds(colours, seeds, white)
    if np.mean(kinds[np.concatenate([_middle(image, model).ravel() for image in words])] == SKIRT) < 0.9:
        raise UserError(f"the middle of the image is not evenly of one colour: {_ADVICE}")
    contrast = (white - np.median(seeds, axis=0)) * np.sqrt([1, 2, 1])
    return ColourTable(skirt, kinds, int(np.argmax(contrast)))


_ADVICE = "put the robot with the skirt 20 to 50 cm straight ahead of the camera, in good light"


def _middle(image: Words, model: CameraModel) -> Words:
    """The pixels that are surely skirt."""
    row, column = round(model.horizon_row), model.width // 2
    up, down, aside = model.height // 60, model.height // 40, model.width // 30
    return image[row - up : row + down, column - aside : column + aside]


def _beside(image: Words, model: CameraModel) -> Words:
    """The rows above the horizon, left and right of the robot: mostly wall."""
    row = round(model.horizon_row)
    above, part = model.height // 30, model.width // 6
    return np.concatenate([image[row - above : row, :part], image[row - above : row, -part:]])


def _white(walls: NDArray[np.float32]) -> NDArray[np.float32]:
    """The colour of the walls: the middle one of the brighter half."""
    brightness = walls.sum(axis=1)
    return np.asarray(np.median(walls[brightness >= np.median(brightness)], axis=0), dtype=np.float32)


def opponent(colours: NDArray[np.float32], white: NDArray[np.float32]) -> NDArray[np.complex64]:
    """Where colours lie around white: the modulus is the saturation (1 for pure light), the angle the hue."""
    balanced = colours / white
    turns = np.exp(2j * np.pi / 3 * np.arange(3))
    return np.asarray(balanced @ turns / balanced.sum(axis=1), dtype=np.complex64)


def _kinds(
    colours: NDArray[np.float32], seeds: NDArray[np.float32], white: NDArray[np.float32]
) -> NDArray[np.uint8]:
    around, seen = opponent(colours, white), opponent(seeds, white)
    middle = np.median(seen.real) + 1j * np.median(seen.imag)
    if abs(middle) < MIN_SATURATION:
        raise UserError(f"the middle of the image has no colour of its own: {_ADVICE}")
    spread_rad = np.std(np.angle(seen / middle))
    tolerance_rad = float(np.clip(HUE_DEVIATIONS * spread_rad, *HUE_TOLERANCE_RAD))
    light = colours.max(axis=1)
    is_skirt = (
        (np.abs(np.angle(around / middle)) < tolerance_rad)
        & (np.abs(around) > PART_OF_SATURATION * abs(middle))
        & (light > PART_OF_LIGHT * np.median(seeds.max(axis=1)))
    )
    is_pale = (np.abs(around) < PALE_SATURATION) & (light > PALE_PART_OF_LIGHT * white.max())
    return np.select([is_skirt, is_pale], [SKIRT, PALE], OTHER).astype(np.uint8)
