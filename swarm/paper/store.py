"""The results of runs on disk: complete files only, each run once, and never those of other settings."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swarm.errors import RunFailedError, UserError
from swarm.files import write_json, write_whole
from swarm.gridworld.condition import Condition
from swarm.paper.conditions import shortened
from swarm.paper.readings import DEFAULT, Readings
from swarm.table_files import as_parquet

if TYPE_CHECKING:
    import polars as pl

    from swarm.gridworld.simulation import Trace


_ENDS = b"PAR1"


@dataclass(frozen=True)
class Timing:
    """How long the engine took for one run."""

    condition: str
    run: int
    seconds: float
    steps: int
    """Of all learners together."""


class RunStore:
    """The runs of one directory; make one with `open_store`."""

    def __init__(self, root: Path, seed: int, steps: int | None, readings: Readings = DEFAULT) -> None:
        self.root = root
        self.seed = seed
        self.steps = steps
        self.readings = readings

    def condition(self, condition: Condition) -> Condition:
        """The condition as it is run here: as it is read, and cut to this directory's number of steps."""
        read = self.readings.of(condition)
        return read if self.steps is None else shortened(read, self.steps)

    def admit(self, condition: Condition) -> None:
        """Make room for a condition; UserError if another one of the same name has been run here."""
        cure = "give the condition another name, or choose another --out"
        _settle(self._folder(condition), plain(self.condition(condition)), cure)

    def has(self, condition: Condition, run: int) -> bool:
        """Whether a whole file of this run is here."""
        path = self._path(condition, run)
        return path.is_file() and _is_whole(path)

    def save(self, condition: Condition, run: int, trace: Trace) -> None:
        """Write a run, whole or not at all."""
        import polars as pl

        learners = len(trace.best_path_length)
        frame = pl.DataFrame(
            {
                "condition": [condition.name] * learners,
                "seed": [self.seed] * learners,
                "run": [run] * learners,
                "learner": list(range(learners)),
                "steps": [trace.steps] * learners,
                "evaluate_every": [condition.evaluate_every] * learners,
                "best_path_length": pl.Series(list(trace.best_path_length), dtype=pl.List(pl.Int32)),
                "ratios": pl.Series(list(trace.ratios), dtype=pl.List(pl.Float64)),
                "replicated": pl.Series(list(trace.replicated), dtype=pl.List(pl.Int64)),
                "tally": pl.Series(list(trace.tally), dtype=pl.List(pl.Int64)),
                "q_error": list(trace.q_error),
            }
        )
        write_whole(self._path(condition, run), as_parquet(frame, compression="zstd"))

    def load(self, condition: Condition, run: int) -> pl.DataFrame:
        """The rows of one run, a learner each."""
        import polars as pl

        return pl.read_parquet(self._path(condition, run))

    def add_timing(self, timing: Timing) -> None:
        with (self.root / "timings.jsonl").open("a") as file:
            # The line starts with its separator, so that one cut short spoils no other.
            file.write("\n" + json.dumps(vars(timing)))

    def timings(self) -> dict[tuple[str, int], Timing]:
        """The last timing of each (condition, run); a line that an interruption cut short is passed over."""
        path = self.root / "timings.jsonl"
        found = map(_timing, path.read_text().splitlines() if path.exists() else [])
        return {(timing.condition, timing.run): timing for timing in found if timing is not None}

    def _folder(self, condition: Condition) -> Path:
        return self.root / "runs" / self.readings.of(condition).name

    def _path(self, condition: Condition, run: int) -> Path:
        return self._folder(condition) / f"{run:05}.parquet"


def open_store(
    root: Path,
    seed: int,
    steps: int | None,
    conditions: Iterable[Condition] = (),
    readings: Readings = DEFAULT,
) -> RunStore:
    """A new directory with room for these conditions, or one that was made with the same settings; any
    other is refused.
    """
    settings = {"made_by": "swarm reproduce", "seed": seed, "steps": steps, "engine": _engine_digest()}
    _settle(root, settings, "choose another --out")
    store = RunStore(root, seed, steps, readings)
    for condition in conditions:
        store.admit(condition)
    return store


def _settle(folder: Path, settings: dict[str, Any], cure: str) -> None:
    """Write a folder's settings, or check that it has the same."""
    path = folder / "settings.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if path.exists():
            _compare(folder, json.loads(path.read_text()), settings, cure)
        elif any(not name.name.endswith(".tmp") for name in folder.iterdir()):
            raise UserError(
                f"{folder} exists and holds something else than results of swarm reproduce; {cure}"
            )
        else:
            write_json(settings, path)
    except (OSError, ValueError, RunFailedError) as error:
        raise UserError(f"{folder} cannot be used for results: {error}; {cure}") from error


def _compare(folder: Path, there: dict[str, Any], asked: dict[str, Any], cure: str) -> None:
    for name in sorted(there.keys() | asked.keys()):
        if there.get(name) != asked.get(name):
            raise UserError(
                f"{folder} holds results with {name} {_short(there.get(name))}, "
                f"but {_short(asked.get(name))} was asked for; {cure}"
            )


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _is_whole(path: Path) -> bool:
    """Whether a Parquet file has both its ends; one cut short by a full disk or a power cut has not."""
    with path.open("rb") as file:
        if file.read(4) != _ENDS:
            return False
        file.seek(-4, os.SEEK_END)
        return file.read(4) == _ENDS


def _timing(line: str) -> Timing | None:
    try:
        return Timing(**json.loads(line))
    except (ValueError, TypeError):
        return None


def _engine_digest() -> str:
    """A fingerprint of the engine's code, so that results of different engines never mix."""
    import swarm.gridworld

    files = sorted(Path(swarm.gridworld.__path__[0]).glob("*.py"))
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def plain(value: Any) -> Any:
    """Dataclasses become objects with their type's name, sets become sorted lists, enums their names."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, frozenset | set):
        return sorted(map(plain, value))
    if isinstance(value, tuple | list):
        return [plain(entry) for entry in value]
    return value
