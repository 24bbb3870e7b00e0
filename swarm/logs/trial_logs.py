"""The logs of one trial: one, or as many as servers went on with it after another had ended."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from pathlib import Path

from swarm.errors import UserError
from swarm.logs.ending import last_of
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.reader import Part

LOG_NAME = re.compile(r"(trial-\d+(?:-\d+)?)\.mcap", re.ASCII)
RECOVERED_NAME = re.compile(r"(trial-\d+(?:-\d+)?)\.recovered\.mcap", re.ASCII)


def logs_in(run: Path, notes: list[str]) -> list[LogIdentity]:
    """All logs of a run directory by trial and part, joined; UserError if there is none.

    `notes` gets a line for each file that is left out.
    """
    paths = _paths_in(run, notes)
    if not paths:
        raise UserError(f"{run}: holds no log (trial-NNN.mcap); is it a run directory?")
    return joined(sorted(map(identify, paths), key=lambda log: (log.trial, log.part)))


def _paths_in(run: Path, notes: list[str]) -> list[Path]:
    """One file a log: a recovered one only where its original is gone, since all of that is read as well."""
    try:
        names = sorted(entry.name for entry in run.iterdir())
    except OSError as error:
        raise UserError(f"{run}: cannot be read ({error.strerror})") from error
    logs = {match[1]: run / match[0] for match in map(LOG_NAME.fullmatch, names) if match}
    for match in filter(None, map(RECOVERED_NAME.fullmatch, names)):
        original = logs.setdefault(match[1], run / match[0])
        if original.name != match[0]:
            notes.append(f"{run}: {match[0]} is left out, {original.name} itself is read")
    return list(logs.values())


def joined(logs: Iterable[LogIdentity]) -> list[LogIdentity]:
    """The same logs, the parts of one trial of one run with the name of the first and the ending of the last.

    A log without a run id, of a simulation, has no other parts; nor has a part that is there twice.
    """
    logs = list(logs)
    parts: dict[tuple[str, int], dict[int, LogIdentity]] = {}
    for log in logs:
        if log.run_id:
            parts.setdefault((log.run_id, log.trial), {}).setdefault(log.part, log)
    found = []
    for log in logs:
        trial = parts.get((log.run_id, log.trial), {})
        if trial.get(log.part) is log:
            ending = last_of([trial[part].ending for part in sorted(trial)])
            log = replace(log, first_part=trial[min(trial)].path, ending=ending)
        found.append(log)
    return found


def trial_of(log: Path) -> int:
    """The trial that a log's name tells of: 0 for trial-000-2.mcap."""
    return int(log.stem.split("-")[1])


def by_trial(logs: Iterable[LogIdentity]) -> list[list[LogIdentity]]:
    """The parts of each trial, of logs that were joined."""
    return [list(parts) for _, parts in groupby(logs, key=lambda log: log.trial_log)]


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
