"""What the emulated camera looks at, and what spoils its pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TagPlate:
    """A white plate with a tag, level on top of a round robot; the tag's top edge points ahead."""

    side_m: float = 0.060
    """The black square."""
    margin_m: float = 0.010
    """White around it: one module of a 36h11 is 7.5 mm."""
    height_m: float = 0.120
    """Of the plate above the floor: an e-puck with its boards, and a distance piece."""
    body_radius_m: float = 0.035

    @property
    def half_m(self) -> float:
        return self.side_m / 2 + self.margin_m


@dataclass(frozen=True)
class Swarm:
    """Robots at the middle of an exposure: ids of tags, poses and velocities (each (n, 3): x, y, theta).

    `tilts_rad` (n, 2) tips the plates forward and to the left; `hidden` (n,) is the part of a plate that
    something covers, from the left.
    """

    ids: tuple[int, ...]
    poses: Floats
    velocities: Floats
    tilts_rad: Floats | None = None
    hidden: Floats | None = None


@dataclass(frozen=True)
class Faults:
    """What spoils the pictures. The defaults are a good machine-vision camera under laboratory lamps."""

    exposure_s: float = 0.008
    row_delay_s: float = 0.0
    """Of a rolling shutter, a row."""
    defocus_px: float = 0.7
    """Standard deviation of the blur of lens and pixel."""
    noise_levels: float = 3.0
    """Standard deviation at mid grey, of 255; half of it is shot noise in variance."""
    darkest_light: float = 0.35
    """The light at the arena's darkest corner, of that at its brightest."""
    lamp_spot: float = 0.3
    """How much brighter the floor under a lamp is."""
    jpeg_quality: int = 0
    """Of the coded frames; 0: not coded."""
