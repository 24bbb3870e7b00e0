"""Which trial of which run a log holds, by its own metadata."""

from __future__ import annotations

import hashlib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from swarm.config.experiment import ArenaSettings, Role
from swarm.files import printable
from swarm.geometry import Grid
from swarm.logs.chain import first_link, last_link
from swarm.logs.ending import BEFORE, Ending, Sender, ending_of, numbers_of
from swarm.logs.reader import LogError, LogReader, open_log

UNKNOWN = "unknown"


@dataclass(frozen=True)
class LogIdentity:
    """A log's place among conditions x trials x seeds."""

    path: Path
    digest: str
    """SHA-256 of the file."""
    run: str
    seed: int
    trial: int
    moves: int
    """How many each learner was to make."""
    commit: str
    """Of the program that recorded it."""
    conditions: Mapping[str, str]
    """Of each robot."""
    learners: frozenset[str]
    cell_m: float
    """The side of a cell of the grids."""
    grid: Grid
    """The cells of each robot's compartment."""
    ending: Ending = field(default_factory=Ending)
    """Of the trial, once its logs were put together."""
    run_id: str = ""
    """Of a run that others could join; empty for a simulation's lockstep."""
    part: int = 1
    """Which of the trial's logs this is, from 1."""
    before: Mapping[Sender, int] = field(default_factory=dict)
    """The last number of each sender in the trial's logs before this one."""
    first_link: str = ""
    """Of the hash chain that it goes on from; empty if from none."""
    last_link: str = ""
    """Of its hash chain; empty if it was not finished."""
    first_part: Path | None = None
    """The log that this one goes on from, once the logs of a trial were put together."""

    @property
    def name(self) -> str:
        """The path as reports and JSON have it."""
        return printable(self.path)

    @property
    def trial_log(self) -> str:
        """What tables call the trial: the path of its first log."""
        return printable(self.first_part or self.path)

    def condition(self, robot: str) -> str:
        """ "unknown" for a robot that the experiment does not name; empty for what is no robot."""
        return self.conditions.get(robot, "" if robot in ("tracker", "server", "run") else UNKNOWN)

    @property
    def shortest_moves(self) -> int:
        """From a grid's start to its goal, the opposite corner."""
        return max(self.grid.columns, self.grid.rows) - 1

    @property
    def replicate(self) -> tuple[int, int]:
        """(seed, trial): two conditions measured in the same one form a pair."""
        return self.seed, self.trial


def identify(path: Path) -> LogIdentity:
    """Read a log's metadata; LogError if it is no log of a run, or not of a single one."""
    reader = LogReader(path)
    reader.read_metadata()
    if reader.contradictions:
        names = ", ".join(sorted(reader.contradictions))
        raise LogError(path, f"does not say which run it holds: two metadata records that differ ({names})")
    return identity_of(reader)


def identity_of(reader: LogReader) -> LogIdentity:
    """What the metadata say that have been read; of records that contradict each other the first counts."""
    path, metadata = reader.path, reader.metadata
    run, robots = metadata.get("run", {}), metadata.get("robots", {})
    experiment = metadata.get("experiment", {}).get("toml", "")
    try:
        arena = _arena(experiment)
        words = {robot: _role_and_condition(text) for robot, text in robots.items()}
        return LogIdentity(
            path=path,
            digest=_digest(path),
            run=run["name"],
            seed=_count(run["seed"]),
            trial=_count(run["trial"]),
            moves=_count(run["moves"]),
            commit=metadata.get("versions", {}).get("commit", UNKNOWN),
            conditions={robot: condition for robot, (_, condition) in words.items()},
            learners=frozenset(robot for robot, (role, _) in words.items() if role == Role.LEARNER.value),
            cell_m=arena.cell_m,
            grid=Grid(arena.columns, arena.rows),
            ending=ending_of(metadata),
            run_id=run.get("id", ""),
            part=_count(run.get("part", "1")),
            before=numbers_of(metadata.get(BEFORE, {})),
            first_link=first_link(metadata),
            last_link=last_link(metadata),
        )
    except (KeyError, ValueError) as error:
        reason = "does not say which run and trial it holds: was it recorded by swarm-server?"
        if reader.damage:
            reason = f"nothing can be read of it: {reader.damage[0]}"
        raise LogError(path, reason) from error


def _role_and_condition(text: str) -> tuple[str, str]:
    role, condition = text.split(" ")
    return role, condition


def _arena(experiment: str) -> ArenaSettings:
    """The experiment's [arena]; the default where it says nothing that makes sense."""
    default = ArenaSettings()
    try:
        said = {**vars(default), **tomllib.loads(experiment).get("arena", {})}
        cell_m, columns, rows = float(said["cell_m"]), int(said["columns"]), int(said["rows"])
    except (ValueError, TypeError, AttributeError):
        return default
    sensible = 0 < cell_m < math.inf and columns > 0 and rows > 0
    return replace(default, cell_m=cell_m, columns=columns, rows=rows) if sensible else default


def _count(text: str) -> int:
    value = int(text)
    if not 0 <= value < 2**63:
        raise ValueError(f"{text} is out of range")
    return value


def _digest(path: Path) -> str:
    with open_log(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
