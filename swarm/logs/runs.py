"""The runs in a directory, by what their servers left: nothing is read of a log but how it was made."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.errors import UserError
from swarm.files import printable
from swarm.logs.reader import LogReader
from swarm.logs.trial_logs import LOG_NAME

MANIFEST, RESULT = "manifest.json", "run.json"
RUNNING, COMPLETE, KILLED = "running", "complete", "killed"
UNKNOWN = "unknown"


@dataclass(frozen=True)
class RunEntry:
    """One run, as a line of a list."""

    path: Path
    name: str
    state: str
    conditions: tuple[str, ...]
    """Of its learners, in the experiment's order."""
    seed: int
    moves: int
    """Of each learner in a trial."""
    trials: int
    complete: int
    """Of the trials."""
    results: Mapping[str, float]
    """Condition -> the last best path length, a mean over learners and trials; empty if none was reported."""
    commit: str
    changes: tuple[str, ...]
    """What `--set` said."""

    def as_json(self) -> dict[str, Any]:
        counts = {"seed": self.seed, "moves": self.moves, "trials": self.trials, "complete": self.complete}
        named = {"run": printable(self.path), "name": self.name, "state": self.state}
        conditions = {"conditions": list(self.conditions), "results": dict(self.results)}
        return named | conditions | counts | {"commit": self.commit, "set": list(self.changes)}


def runs_in(directory: Path) -> list[RunEntry]:
    """The run that a directory is, or those in it, by name; UserError if it is no directory."""
    try:
        places = [directory, *sorted(entry for entry in directory.iterdir() if entry.is_dir())]
    except OSError as error:
        raise UserError(f"{printable(directory)}: cannot be listed ({error.strerror})") from error
    return [entry for place in places for entry in _entry(place)]


def _entry(place: Path) -> Iterator[RunEntry]:
    """Nothing for a directory that no server made."""
    manifest, result = _read(place / MANIFEST), _read(place / RESULT)
    with suppress(KeyError, TypeError, ValueError, AttributeError):
        records = [record for record in manifest["trials"] if record["role"] == "learner"]
        states = {int(record["trial"]): str(record["state"]) for record in records}
        group = {str(record["robot"]): str(record["condition"]) for record in records}
        yield RunEntry(
            place,
            str(manifest["name"]),
            _state(place, set(states.values())),
            tuple(dict.fromkeys(group.values())),
            int(records[0]["seed"]),
            int(manifest["moves"]),
            len(states),
            sum(state == COMPLETE for state in states.values()),
            _results(result, group),
            _commit(place),
            tuple(map(str, manifest.get("set", ()))),
        )


def _read(file: Path) -> Any:
    """An empty object for a file that is not there or no JSON."""
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}


def _state(place: Path, states: set[str]) -> str:
    """Of a trial that did not come to its end. A server that was killed could not say so: it has left the
    directory that it held.
    """
    if RUNNING in states:
        return RUNNING if _is_held(place) else KILLED
    return min(states - {COMPLETE}, default=COMPLETE)


def _is_held(place: Path) -> bool:
    descriptor = os.open(place, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _results(result: Mapping[str, Any], group: Mapping[str, str]) -> dict[str, float]:
    lengths: dict[str, list[int]] = {}
    for trial in result.get("trials", ()):
        for robot, length in trial.get("best_paths", {}).items():
            lengths.setdefault(group[robot], []).append(int(length))
    return {condition: sum(found) / len(found) for condition, found in lengths.items()}


def _commit(place: Path) -> str:
    """Of the program that recorded the first log."""
    logs = sorted(entry for entry in place.iterdir() if LOG_NAME.fullmatch(entry.name))
    with suppress(UserError):
        for log in logs:
            reader = LogReader(log)
            metadata = reader.metadata if reader.read_index() else reader.read_metadata()
            return metadata.get("versions", {}).get("commit", UNKNOWN)
    return UNKNOWN
