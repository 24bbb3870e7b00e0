"""What real links and robots do wrong, each to be switched on."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from swarm.errors import UserError, nearest


@dataclass(frozen=True)
class Faults:
    """Faults of one emulated robot; all are off at first. Chances are of each reply or transfer."""

    bad_checksum: float = 0.0
    """Chance that a bit of an I2C reply turns over."""
    failure: float = 0.0
    """Chance that an I2C or SPI transfer fails; on a Pi-puck about 0.001."""
    stall: float = 0.0
    """Chance that the Wi-Fi robot sends nothing for `stall_s`."""
    stall_s: float = 1.5
    """The ESP32 sleeps a second after a bad read: pauses of 1.3 to 1.7 s were measured."""
    pieces: float = 0.0
    """Chance that a reply arrives in two pieces, the second one exchange late."""
    banner: float = 0.0
    """Chance that the robot's greeting stands in the middle of a serial reply, as after a brown-out."""
    drop_after_s: float = 0.0
    """The link drops after so long, and again so long after each return; 0: never."""
    drop_for_s: float = 2.0
    """It returns after so long. Meanwhile the wheels run on as they were told."""
    ignores_reset: float = 0.0
    """1: the e-puck2's firmware, whose `R` does nothing."""
    sag_v_per_s: float = 0.0
    """How fast the battery sags from 4.1 V."""
    remote_after_s: float = 0.0
    """From then on a TV remote in the room tells the robot to drive, ten times a second; 0: never."""

    @classmethod
    def parse(cls, texts: list[str]) -> Faults:
        """Faults from texts such as "failure=0.001"; UserError for what is none."""
        known = [field.name for field in fields(cls)]
        faults = cls()
        for text in texts:
            name, _, value = text.partition("=")
            if name not in known:
                raise UserError(f"--fault {name!r} is unknown; {nearest(name, known)}")
            try:
                faults = replace(faults, **{name: float(value)})
            except ValueError as error:
                raise UserError(f"--fault {text!r}: {name} takes a number, as in {name}=0.01") from error
        return faults
