"""What a demonstrator looks like, as data: its skirt's size and colour, and what is seen above the skirt.

Colours are parts of a white wall's light in the same frame (linear red, green, blue), so they hold in any
light.
"""

from __future__ import annotations

from dataclasses import dataclass, field

Colour = tuple[float, float, float]
"""Linear red, green and blue."""

SKIRT_RADIUS_M = 0.0355
"""The e-puck's: its diameter is 71 mm."""
SKIRT_BOTTOM_M = 0.004
SKIRT_TOP_M = 0.042
"""Chosen, the paper gives neither: it clears the floor and leaves the top of the body, of 50 mm, free."""


@dataclass(frozen=True)
class Skirt:
    """[skirt]: an upright cylinder of one colour."""

    name: str = "red"
    radius_m: float = SKIRT_RADIUS_M
    bottom_m: float = SKIRT_BOTTOM_M
    top_m: float = SKIRT_TOP_M
    colour: Colour = (0.68, 0.04, 0.04)
    hue_tolerance_rad: float = 0.18

    def __post_init__(self) -> None:
        checks = {
            "the skirt's radius must be in 5..200 mm": 0.005 <= self.radius_m <= 0.2,
            "the skirt must be 5..300 mm high": 0.005 <= self.top_m - self.bottom_m <= 0.3,
            "the skirt's bottom must not be below the floor": self.bottom_m >= 0,
            "the skirt's colour must be three parts of the wall's light, in 0..2, not all 0": max(self.colour)
            > 0
            and all(0 <= part <= 2 for part in self.colour),
            "the hue's tolerance must be in 0.02..0.5 rad": 0.02 <= self.hue_tolerance_rad <= 0.5,
        }
        for wrong, holds in checks.items():
            if not holds:
                raise ValueError(wrong)

    @property
    def height_m(self) -> float:
        return self.top_m - self.bottom_m

    @property
    def edge_channel(self) -> int:
        """The channel (0 red, 1 green, 2 blue) in which the skirt stands out best against a white wall.

        Green is worth more than its contrast: a Bayer mosaic samples it twice as often.
        """
        contrast = [(1 - part) * worth for part, worth in zip(self.colour, (1, 2**0.5, 1), strict=True)]
        return contrast.index(max(contrast))


@dataclass(frozen=True)
class Hat:
    """[hat]: what is seen right above the skirt, be it the boards or a hat that lies on it."""

    colour: Colour

    @property
    def stands_out(self) -> bool:
        """Whether it cannot be taken for the wall: then whatever has wall above it is no demonstrator."""
        return min(self.colour) < STANDS_OUT


STANDS_OUT = 0.5
"""Of the wall's light in the darkest channel; chosen: a wall in the shade is lighter."""


@dataclass(frozen=True)
class Demonstrator:
    """A robot to look for. `white` is the wall's light (parts of full scale) when it was calibrated."""

    skirt: Skirt = field(default_factory=Skirt)
    hat: Hat | None = None
    white: Colour = (0.6, 0.6, 0.6)
