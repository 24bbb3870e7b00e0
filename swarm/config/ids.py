"""What the names of runs, laboratories and robots may be, said with a line in their file."""

from __future__ import annotations

from swarm.config.toml_files import ConfigFile
from swarm.messages.topics import NO_ROBOT, is_id

_RULE = "an id starts with a small letter and has at most 32 of a-z, 0-9, _ and -"


def check_id(value: str, where: tuple[str | int, ...], file: ConfigFile) -> None:
    """UserError if the value of a key is no id."""
    if not is_id(value):
        raise file.error(where, f"{where[-1]!r} is {value!r}; {_RULE}")


def check_robot_id(value: str, where: tuple[str | int, ...], file: ConfigFile) -> None:
    """UserError if no robot may be called so."""
    check_id(value, where, file)
    if value in NO_ROBOT:
        names = ", ".join(sorted(NO_ROBOT))
        raise file.error(where, f"{where[-1]!r} is {value!r}, as in keys that name no robot ({names})")
