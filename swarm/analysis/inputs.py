"""The logs that a call of `swarm analyze` names: found, identified, and fit to be put together."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from swarm.errors import UserError
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.runs import MANIFEST
from swarm.logs.trial_logs import closed_path, joined, logs_in


@dataclass(frozen=True)
class Inputs:
    """The logs to analyze, in order, and what a reader of the results should know of them."""

    logs: tuple[LogIdentity, ...]
    notes: list[str] = field(default_factory=list)

    @property
    def shortest_moves(self) -> int:
        """No best path in these logs can be shorter."""
        return min(log.shortest_moves for log in self.logs)


def find_inputs(runs: Sequence[Path]) -> Inputs:
    """The logs of run directories and log files; UserError if they cannot be analyzed together."""
    notes: list[str] = []
    logs = joined(identity for run in runs for identity in _logs_of(run, notes))
    _refuse_repetitions(logs)
    commits = sorted({log.commit for log in logs})
    if len(commits) > 1:
        notes.append(
            f"the logs were recorded by {len(commits)} versions of the program: {', '.join(commits)}"
        )
    return Inputs(tuple(logs), notes)


def default_out(runs: Sequence[Path]) -> Path:
    """`RUN/analysis`, or beside a single log; UserError for several runs, which have no place in common."""
    if len(runs) != 1:
        raise UserError(f"{len(runs)} runs are analyzed together: say with --out where the results go")
    run = runs[0]
    return run / "analysis" if run.is_dir() else run.with_name(f"{run.stem}-analysis")


def _logs_of(run: Path, notes: list[str]) -> list[LogIdentity]:
    if not run.is_dir():
        return [identify(run)]
    logs = logs_in(run, notes)
    _refuse_mixture(run, logs)
    notes.extend(_missing(run, {closed_path(log.path).name for log in logs}))
    return logs


def _refuse_mixture(run: Path, logs: list[LogIdentity]) -> None:
    """A run's directory holds the trials of one run."""
    first = logs[0]
    for log in logs[1:]:
        if (log.run, log.seed, log.moves, log.conditions) != (
            first.run,
            first.seed,
            first.moves,
            first.conditions,
        ):
            raise UserError(
                f"{run}: {first.path.name} and {log.path.name} are of two different runs "
                f"({first.run!r} seed {first.seed}, {log.run!r} seed {log.seed}); "
                "keep each run in a directory of its own"
            )


def _missing(run: Path, found: set[str]) -> list[str]:
    """Notes on trials that the run's manifest promises, and that have no log or were not finished."""
    try:
        records = json.loads((run / MANIFEST).read_text(encoding="utf-8"))["trials"]
        states = {str(record["log"]): str(record["state"]) for record in records}
    except FileNotFoundError:
        return []
    except (OSError, ValueError, KeyError, TypeError) as error:
        return [f"{run / MANIFEST} cannot be read ({error}): whether logs are missing is not known"]
    absent = sorted(states.keys() - found)
    notes = (
        [f"{run}: {len(absent)} of {len(states)} trials have no log: {', '.join(absent)}"] if absent else []
    )
    unfinished = sorted(log for log, state in states.items() if log in found and state != "complete")
    return notes + [f"{run}: {log} was {states[log]} when the manifest was written" for log in unfinished]


def _refuse_repetitions(logs: list[LogIdentity]) -> None:
    """A trial counts once: the same random numbers again are no independent replicate."""
    seen: dict[tuple[str, int, int], LogIdentity] = {}
    for log in logs:
        for condition in sorted({log.conditions[robot] for robot in log.learners}):
            before = seen.setdefault((condition, *log.replicate), log)
            if before.trial_log != log.trial_log or (before is not log and before.path == log.path):
                same = "is given twice" if before.digest == log.digest else "is in both"
                raise UserError(
                    f"{before.path} and {log.path}: trial {log.trial} of seed {log.seed} of {condition!r} "
                    f"{same}; the same seed gives no independent trial: leave one out, "
                    "or run it with another --seed"
                )
