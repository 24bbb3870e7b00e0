"""The logs of one trial: one, or several if it grew too large for one, the disk was full, or another server
went on with it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from swarm.errors import UserError
from swarm.logs.ending import last_of
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.reader import Part

OPEN_SUFFIX = ".part"
"""Ends the name of a log that is being written, or that a server left which was killed."""
LOG_NAME = re.compile(rf"(trial-\d+(?:-\d+)?)\.mcap(?:{re.escape(OPEN_SUFFIX)})?", re.ASCII)
RECOVERED_NAME = re.compile(r"(trial-\d+(?:-\d+)?)\.recovered\.mcap", re.ASCII)


def closed_path(log: Path) -> Path:
    """A log's path once it is closed."""
    return log.with_name(log.name.removesuffix(OPEN_SUFFIX))


def open_path(log: Path) -> Path:
    """A log's path while it is written."""
    return log.with_name(log.name + OPEN_SUFFIX)


def logs_in(run: Path, notes: list[str]) -> list[LogIdentity]:
    """All logs of a run directory by trial and part, joined; UserError if there is none.

    `notes` gets a line for each file that is left out.
    """
    paths = _paths_in(run, notes)
    if not paths:
        raise UserError(f"{run}: holds no log (trial-NNN.mcap); is it a run directory?")
    return joined(sorted(map(identify, paths), key=lambda log: (log.trial, log.part)))


def logs_of_trial(places: Iterable[Path]) -> list[Path]:
    """Files as they are, and of a run directory the logs of its trial; UserError if it holds several."""
    found = []
    for place in places:
        trials = by_trial(logs_in(place, [])) if place.is_dir() else []
        if len(trials) > 1:
            raise UserError(f"{place}: holds {len(trials)} trials; name the logs of one")
        found += [log.path for log in trials[0]] if trials else [place]
    return found


def _paths_in(run: Path, notes: list[str]) -> list[Path]:
    """One file a log: a recovered one only where its original is gone, since all of that is read as well."""
    try:
        names = sorted(entry.name for entry in run.iterdir())
    except OSError as error:
        raise UserError(f"{run}: cannot be read ({error.strerror})") from error
    logs: dict[str, Path] = {}
    for match in filter(None, map(LOG_NAME.fullmatch, names)):
        logs.setdefault(match[1], run / match[0])
    for match in filter(None, map(RECOVERED_NAME.fullmatch, names)):
        original = logs.setdefault(match[1], run / match[0])
        if original.name != match[0]:
            notes.append(f"{run}: {match[0]} is left out, {original.name} itself is read")
    return list(logs.values())


def joined(logs: Iterable[LogIdentity]) -> list[LogIdentity]:
    """The same logs, the parts of one trial of one run with the name of the first and the ending of the last.

    A part that is there twice is left alone.
    """
    logs = list(logs)
    parts: dict[object, dict[int, LogIdentity]] = {}
    for log in logs:
        parts.setdefault(_trial_of(log), {}).setdefault(log.part, log)
    found = []
    for log in logs:
        trial = parts[_trial_of(log)]
        if len(trial) > 1 and trial.get(log.part) is log:
            first, ending = trial[min(trial)], last_of([trial[part].ending for part in sorted(trial)])
            log = replace(log, first_part=first.path, before=first.before, ending=ending)
        found.append(log)
    return found


def _trial_of(log: LogIdentity) -> object:
    """What the parts of a trial have in common: in lockstep, where no run has an id, the place."""
    return (log.run_id or log.path.parent, log.run, *log.replicate)


def trial_of(log: Path) -> int:
    """The trial that a log's name tells of: 0 for trial-000-2.mcap."""
    return int(closed_path(log).stem.split("-")[1])


def part_of(log: Path) -> int:
    """The part that a log's name tells of: 1 for trial-000.mcap, 2 for trial-000-2.mcap."""
    return int(closed_path(log).stem.split("-")[2]) if log.name.count("-") > 1 else 1


def by_trial(logs: Iterable[LogIdentity]) -> list[list[LogIdentity]]:
    """The parts of each trial, of logs that were joined."""
    trials: dict[str, list[LogIdentity]] = {}
    for log in logs:
        trials.setdefault(log.trial_log, []).append(log)
    return list(trials.values())


def misplaced(parts: Sequence[LogIdentity], first: LogIdentity) -> list[str]:
    """Why the parts of a trial are not what a run directory whose first log is `first` should hold of it."""
    found = []
    numbers = {log.part for log in parts}
    for part in sorted(set(range(1, max(numbers))) - numbers):
        found.append(f"part {part} of trial {parts[0].trial} is not here")
    if _run_of(parts[0]) != _run_of(first):
        found.append(f"{parts[0].path.name} is of another run than {first.path.name}")
    elif parts[0].first_part is None and parts[0].trial_log != first.trial_log and parts[0].part > 1:
        found.append(f"{parts[0].path.name} is part {parts[0].part} of trial {parts[0].trial} once more")
    return found


def _run_of(log: LogIdentity) -> object:
    return (log.run_id, log.run, log.seed)


def trials_of(path: Path) -> list[list[LogIdentity]]:
    """The parts of each trial of a run directory, or of the one that a log holds."""
    return by_trial(logs_in(path, [])) if path.is_dir() else [[identify(path)]]


def as_one(part: Part, log: LogIdentity) -> Part:
    """A part of a log for a table over all logs of the trial: there a sender has one channel a key.

    Channels without an epoch are the server's drawings, numbered anew in each log.
    """
    if log.first_part is None:
        return part
    number = 1 if part.channel.epoch else log.part
    return replace(part, channel=replace(part.channel, id=number))
