"""How long moves take on a robot: measured in a log, kept in a small file, drawn by the abstract engine."""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from swarm.errors import UserError
from swarm.geometry import MOVES, Move

COLUMNS = ["kind", "duration_s"]
HEADING_AT_THE_START = int(Move.E)
HEADING_AFTER_THE_DRIVE_BACK = int(Move.NW)
DRIVE_BACK = "drive_back"
"""From the arrival in the goal to the first choice in the start: the rests and the drive between them."""
MOST_OF_A_KIND = 200


def kind_of(heading: int, action: int) -> str:
    """What a driven move's duration depends on: its turn, in eighths of a circle, and side or diagonal."""
    turn = (action - heading) % MOVES
    return f"turn{min(turn, MOVES - turn)}-{'diagonal' if action % 2 else 'side'}"


KINDS = (*(f"turn{turn}-{way}" for turn in range(5) for way in ("side", "diagonal")), DRIVE_BACK)


@dataclass(frozen=True)
class Step:
    """A move as a log has it."""

    robot: str
    action: int
    blocked: bool
    arrived: bool
    duration_s: float
    ended_s: float


def measured(steps: Iterable[Step], carried_s: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """Seconds by kind, in the order of the log, for the steps of any number of robots in order of time.

    A drive back in which the robot was carried (robot -> times) was a visit, and does not count.
    """
    headings: dict[str, int] = {}
    arrivals_s: dict[str, float] = {}
    found: dict[str, list[float]] = defaultdict(list)
    for step in steps:
        if step.robot in arrivals_s:
            arrived_s, began_s = arrivals_s.pop(step.robot), step.ended_s - step.duration_s
            if not any(arrived_s <= t_s <= began_s for t_s in carried_s.get(step.robot, ())):
                found[DRIVE_BACK].append(began_s - arrived_s)
        if not step.blocked:
            kind = kind_of(headings.get(step.robot, HEADING_AT_THE_START), step.action)
            found[kind].append(step.duration_s)
            headings[step.robot] = HEADING_AFTER_THE_DRIVE_BACK if step.arrived else step.action
        if step.arrived:
            arrivals_s[step.robot] = step.ended_s
    return dict(found)


class Durations:
    """Draws a duration out of those measured of a kind."""

    def __init__(self, seconds: Mapping[str, list[float]]) -> None:
        missing = [kind for kind in KINDS if not seconds.get(kind)]
        if missing:
            raise UserError(f"no duration of {', '.join(missing)} was measured: use a longer run")
        self._seconds = dict(seconds)

    def drawn(self, kind: str, rng: np.random.Generator) -> float:
        seen = self._seconds[kind]
        return seen[int(rng.integers(len(seen)))]


def write_durations(seconds: Mapping[str, list[float]], path: Path, told: str) -> None:
    """A new CSV file with up to 200 durations of each kind; UserError if it is there."""
    try:
        with path.open("x", newline="", encoding="utf-8") as file:
            file.write(f"# {told}\n")
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(COLUMNS)
            for kind in KINDS:
                writer.writerows((kind, f"{s:.3f}") for s in seconds.get(kind, [])[:MOST_OF_A_KIND])
    except FileExistsError as error:
        raise UserError(f"{path} is there already: choose another name or remove it") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror})") from error


def load_durations(path: Path) -> Durations:
    """Read a file that `write_durations` wrote; UserError names it and what is wrong with it."""
    seconds: dict[str, list[float]] = defaultdict(list)
    try:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        for row in csv.DictReader(lines):
            seconds[row["kind"]].append(_positive(row["duration_s"]))
    except (OSError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise UserError(f"durations {path}: {error}; make them with `swarm durations`") from error
    return Durations(seconds)


def _positive(text: str) -> float:
    seconds = float(text)
    if not 0 < seconds < 3600:
        raise ValueError(f"{text} is no duration in seconds")
    return seconds
