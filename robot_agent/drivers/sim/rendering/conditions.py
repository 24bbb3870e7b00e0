"""How good the light, the lens and the sensor of a simulated camera are."""

from __future__ import annotations

from dataclasses import dataclass

from swarm.errors import UserError, nearest


@dataclass(frozen=True)
class Conditions:
    """Light and sensor, as parts of full scale unless the name says otherwise.

    `white_level` is what a white wall reads at the middle exposure; each camera draws its exposure and its
    colour cast once, within the spreads (standard deviations), and its exposure drifts from frame to frame.
    `distractors` posts of any colour are put along the walls of the first room.
    """

    white_level: float = 0.62
    exposure_spread: float = 0.05
    exposure_drift: float = 0.01
    cast_spread: float = 0.04
    full_well_electrons: float = 4000.0
    read_noise: float = 0.006
    lens_blur_rad: float = 0.0019
    exposure_s: float = 0.020
    readout_s: float = 0.060
    texture: float = 1.0
    distractors: int = 0
    cast: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Of red, green and blue light, beside the drawn one: (1.2, 1, 0.8) is the light of a warm lamp."""


_NAMED = {
    "realistic": Conditions(),
    "hard": Conditions(
        exposure_spread=0.15,
        exposure_drift=0.03,
        cast_spread=0.12,
        full_well_electrons=1000.0,
        read_noise=0.012,
        lens_blur_rad=0.0025,
        texture=1.5,
        distractors=3,
    ),
    "dark": Conditions(white_level=0.004),
    "clean": Conditions(
        exposure_spread=0.0,
        exposure_drift=0.0,
        cast_spread=0.0,
        full_well_electrons=1e9,
        read_noise=0.0,
        exposure_s=0.0,
        readout_s=0.0,
        texture=0.0,
    ),
}


def conditions(name: str) -> Conditions:
    """The named conditions: realistic, hard, dark (lights off) or clean; UserError for another name."""
    if name not in _NAMED:
        raise UserError(f"unknown camera conditions {name!r}; {nearest(name, _NAMED)}")
    return _NAMED[name]
