"""The logs of one trial: one, or as many as servers went on with it after another had ended."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from pathlib import Path

from swarm.errors import UserError
from swarm.logs.identity import LogIdentity, identify

LOG_PATTERN = "trial-*.mcap"


def logs_in(run: Path) -> list[LogIdentity]:
    """All logs of a run directory by trial and part, joined; UserError if there is none."""
    paths = sorted(run.glob(LOG_PATTERN))
    if not paths:
        raise UserError(f"{run}: holds no log ({LOG_PATTERN}); is it a run directory?")
    return joined(sorted(map(identify, paths), key=lambda log: (log.trial, log.part)))


def joined(logs: Iterable[LogIdentity]) -> list[LogIdentity]:
    """The same logs, the parts of one trial of one run under the name of the first of them.

    A log without a run id, of a simulation, has no other parts; nor has a part that is there twice.
    """
    firsts: dict[tuple[str, int], LogIdentity] = {}
    taken: set[tuple[str, int, int]] = set()
    found = []
    for log in logs:
        place = (log.run_id, log.trial, log.part)
        if log.run_id and place not in taken:
            taken.add(place)
            first = firsts.setdefault((log.run_id, log.trial), log)
            found.append(replace(log, first_part=first.path))
        else:
            found.append(log)
    return found


def by_trial(logs: Iterable[LogIdentity]) -> list[list[LogIdentity]]:
    """The parts of each trial, of logs that were joined."""
    return [list(parts) for _, parts in groupby(logs, key=lambda log: log.trial_log)]
