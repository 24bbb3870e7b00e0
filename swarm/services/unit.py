"""The part of a systemd unit that says how a process is started, watched and started again."""

from __future__ import annotations

import re
from collections.abc import Mapping
from configparser import ConfigParser, Error
from dataclasses import dataclass
from pathlib import Path

from swarm.errors import UserError

_VARIABLE = re.compile(r"\$\{(\w+)\}")
_SECONDS = {"": 1.0, "s": 1.0, "ms": 0.001, "min": 60.0}


@dataclass(frozen=True)
class Unit:
    """A service. Times are in seconds; 0 is no limit."""

    command: tuple[str, ...]
    environment: Mapping[str, str]
    working_directory: Path
    start_within_s: float
    stop_within_s: float
    watchdog_s: float
    restart: str
    """`no`, `on-failure` or `always`."""
    restart_after_s: float
    restart_after_at_most_s: float

    @classmethod
    def read(cls, file: Path, instance: str) -> Unit:
        """A unit file as systemd reads it for an instance; UserError if it is none."""
        values = _section(file)
        environment = _environment(values.get("EnvironmentFile", "").replace("%i", instance))
        command = values["ExecStart"].replace("%i", instance)
        longest = values.get("RestartMaxDelaySec", values.get("RestartSec", "0.1"))
        return cls(
            command=_words(command, environment),
            environment=environment,
            working_directory=Path(values.get("WorkingDirectory", "/")),
            start_within_s=_seconds(values.get("TimeoutStartSec", "90")),
            stop_within_s=_seconds(values.get("TimeoutStopSec", "90")),
            watchdog_s=_seconds(values.get("WatchdogSec", "0")),
            restart=values.get("Restart", "no"),
            restart_after_s=_seconds(values.get("RestartSec", "0.1")),
            restart_after_at_most_s=_seconds(longest),
        )

    def starts_again(self, exit_code: int) -> bool:
        """Whether a process that ended so is started again."""
        return self.restart == "always" or (self.restart == "on-failure" and exit_code != 0)


def _section(file: Path) -> dict[str, str]:
    parser = ConfigParser(strict=False, interpolation=None, delimiters=("=",), comment_prefixes=("#", ";"))
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    try:
        parser.read_string(file.read_text(encoding="utf-8"), str(file))
        return {"ExecStart": parser["Service"]["ExecStart"], **parser["Service"]}
    except (OSError, ValueError, KeyError, Error) as error:
        raise UserError(f"{file}: no unit of a service ({error})") from error


def _environment(file: str) -> dict[str, str]:
    """NAME=VALUE lines; a file whose name begins with - may be missing."""
    path = Path(file.removeprefix("-"))
    if not file or (file.startswith("-") and not path.exists()):
        return {}
    lines = path.read_text(encoding="utf-8").splitlines()
    return dict(line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))


def _words(command: str, environment: Mapping[str, str]) -> tuple[str, ...]:
    """As systemd splits: ${NAME} is put in as it is, a word $NAME becomes as many words as it has."""
    words: list[str] = []
    for word in command.split():
        if word.startswith("$") and not word.startswith("${"):
            words += environment.get(word[1:], "").split()
        else:
            words.append(_VARIABLE.sub(lambda name: environment.get(name[1], ""), word))
    return tuple(words)


def _seconds(text: str) -> float:
    found = re.fullmatch(r"([0-9.]+)\s*([a-z]*)", text.strip())
    if not found or found[2] not in _SECONDS:
        raise UserError(f"{text!r} is no time such as 30, 30s or 1min")
    return float(found[1]) * _SECONDS[found[2]]
