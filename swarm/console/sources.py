"""Where a console hears of a run: its log, finished or being written, or the run's own messages."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Protocol

from swarm.config.experiment import Experiment
from swarm.console.polling import Polled
from swarm.console.run_history import SHOWN, About, RunHistory
from swarm.errors import UserError
from swarm.files import printable
from swarm.logs.follow import LogFollower, Timed
from swarm.logs.info import logs_named
from swarm.logs.reader import LogChannel, LogReader
from swarm.logs.trial_logs import LOG_NAME, part_of, trial_of

AT_ONCE = 500
"""Messages taken in while nobody can look: some milliseconds of work."""


POLL_S = 0.02
"""Below the period of a frame; a log that is read from disk is polled without a pause until it is read."""


class Source(Polled, Protocol):
    """What fills the history of a run, a little at each `poll`."""

    @property
    def history(self) -> RunHistory | None:
        """Of the run that is heard of now; None while nothing is known of it."""

    @property
    def is_live(self) -> bool:
        """Whether more is to come."""

    @property
    def is_read(self) -> bool:
        """Whether there is nothing more to come, and everything is taken in."""

    @property
    def state(self) -> str:
        """For people, in some words: how the source does."""


def take_in(history: RunHistory, messages: Sequence[Timed]) -> None:
    """Into the history, with room in between for whoever looks at it."""
    left = iter(messages)
    while some := list(islice(left, AT_ONCE)):
        with history.lock:
            for t_ns, item in some:
                history.add(t_ns, item)


class LogSource:
    """The log of a trial, or the logs that it was divided into, read from front to back."""

    def __init__(self, logs: Sequence[Path]) -> None:
        self._followers = [LogFollower(path, _is_shown) for path in logs]
        self._history = RunHistory(*_told_by(logs[0]))
        self._reading = 0

    @property
    def history(self) -> RunHistory:
        return self._history

    @property
    def is_live(self) -> bool:
        return not self._followers[-1].is_closed

    @property
    def is_read(self) -> bool:
        return self._followers[-1].ended

    @property
    def state(self) -> str:
        follower = self._followers[self._reading]
        if follower.ended:
            return "the whole log is read"
        if not follower.is_closed and follower.share > 0.99:
            return "following the log"
        return f"reading the log: {100 * follower.share:.0f} %"

    def poll(self) -> bool:
        """One chunk, so that whoever waits for its end waits for no more."""
        follower = self._followers[self._reading]
        found = next(follower.read(), None)
        if found is not None:
            take_in(self._history, found)
        elif self._reading + 1 < len(self._followers):
            self._reading += 1
        return found is not None

    def close(self) -> None:
        for follower in self._followers:
            follower.close()


def logs_of_trial(place: Path, trial: int | None) -> list[Path]:
    """The logs of one trial of a run directory, the last trial's by default; or the one log that is named."""
    if not place.is_dir():
        return [place]
    logs = [path for path in logs_named([place]) if LOG_NAME.fullmatch(path.name)]
    trials = sorted({trial_of(path) for path in logs})
    if not trials:
        raise UserError(f"{place}: holds no log (trial-NNN.mcap); is it a run directory?")
    if trial is not None and trial not in trials:
        raise UserError(f"{place}: holds no log of trial {trial}; there are {', '.join(map(str, trials))}")
    chosen = trials[-1] if trial is None else trial
    return sorted((path for path in logs if trial_of(path) == chosen), key=part_of)


def _is_shown(channel: LogChannel) -> bool:
    return channel.topic in SHOWN


def _told_by(log: Path) -> tuple[Experiment, About]:
    """The experiment that a log was recorded from, and which trial it holds; UserError for another log."""
    metadata = LogReader(log).read_metadata()
    run, text = metadata.get("run", {}), metadata.get("experiment", {}).get("toml")
    try:
        numbers = {name: int(run[name]) for name in ("seed", "moves", "trial")}
    except (KeyError, ValueError) as error:
        raise UserError(f"{log}: does not say which run it holds; was it recorded here?") from error
    experiment = Experiment.of_log(printable(log), text or "", {})
    about = About(
        printable(log),
        numbers["trial"],
        metadata.get("versions", {}).get("commit", "unknown"),
        run.get("id", ""),
    )
    return experiment.changed(seed=numbers["seed"], moves=numbers["moves"]), about
