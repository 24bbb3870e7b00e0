"""The file that says which hats a laboratory has."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from swarm.config.toml_files import ConfigFile
from tracker_bridge.hats.patterns import Hat


@dataclass(frozen=True)
class HatSettings:
    """[[hat]]: one robot's pins."""

    name: str
    """The robot's id."""
    pins_mm: tuple[tuple[float, float], ...]
    """Each pin's millimetres ahead of and to the left of the robot's axis."""


@dataclass(frozen=True)
class HatFile:
    """The whole file."""

    hat: tuple[HatSettings, ...]


def load_hats(path: Path) -> list[Hat]:
    """The hats of a file; UserError, with the line, for anything that is not one."""
    file = ConfigFile(path)
    hats = file.settings(HatFile).hat
    for number, hat in enumerate(hats):
        if hat.name in [other.name for other in hats[:number]]:
            raise file.error(("hat", number, "name"), f"two hats are named {hat.name!r}")
        if len(hat.pins_mm) != len(hats[0].pins_mm):
            raise file.error(("hat", number, "pins_mm"), "this hat has another number of pins than the first")
    return [Hat(hat.name, tuple(complex(x, y) / 1e3 for x, y in hat.pins_mm)) for hat in hats]


def hats_as_toml(hats: list[Hat]) -> str:
    """What `load_hats` reads."""
    return "\n".join(_as_toml(hat) for hat in hats)


def _as_toml(hat: Hat) -> str:
    pins = ", ".join(f"[{_mm(pin.real)}, {_mm(pin.imag)}]" for pin in hat.pins)
    return f'[[hat]]\nname = "{hat.name}"\npins_mm = [{pins}]\n'


def _mm(metres: float) -> str:
    return f"{1e3 * metres + 0.0:.2f}"
