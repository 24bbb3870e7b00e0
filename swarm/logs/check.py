"""Is a log complete and sound? Every reason why it is not, in words.

Sound: every checksum is right, the index's too, and every message can be what its key promises. Complete:
every learning event and order of every sender is there, from its first to its last, across restarts. Where
a log cannot show that, it is not complete.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from swarm.files import printable
from swarm.logs.chain import Chain
from swarm.logs.completeness import HealthTable, Hole, health_totals
from swarm.logs.ending import COMPLETE, CONTINUED, Ending
from swarm.logs.identity import LogIdentity, identity_of
from swarm.logs.reader import LogReader, Part
from swarm.logs.tables import is_tabled, rows
from swarm.logs.trial_logs import as_one, by_trial, logs_in, misplaced
from swarm.messages import topics
from swarm.messages.validation import MAX_T_NS


@dataclass(frozen=True)
class LogCheck:
    """What was found in a log."""

    path: Path
    messages: int
    indexed: bool
    damage: list[str]
    """Why it is not sound: damage, no index, no checksum, duplicates, undecodable messages."""
    lacking: list[str]
    """Why it is not complete: learning events lost, or no telling whether any are."""
    remarks: list[str]
    """What is worth knowing and no fault: restarts, states of which only the newest counts, slow keys."""
    events: int
    """Messages that must not be lost, as far as it is known that they were sent."""
    holes: list[Hole]
    """Where some of these are missing."""

    @property
    def share(self) -> float:
        """How many of these are there."""
        missing = sum(hole.last - hole.first + 1 for hole in self.holes)
        return 1 - missing / self.events if self.events else 1.0

    @property
    def faults(self) -> list[str]:
        """Everything that is wrong."""
        return self.damage + self.lacking

    @property
    def sound(self) -> bool:
        """The verdict: neither damaged nor lacking anything."""
        return not self.faults

    def as_json(self) -> dict[str, Any]:
        return {
            "log": printable(self.path),
            "sound": self.sound,
            "complete": not self.lacking,
            "intact": not self.damage,
            "messages": self.messages,
            "indexed": self.indexed,
            "faults": self.faults,
            "remarks": self.remarks,
            "events": self.events,
            "share": self.share,
            "holes": [vars(hole) for hole in self.holes],
        }


@dataclass
class _Contents:
    """What the messages of a trial's logs tell themselves, part by part."""

    health: HealthTable
    begins: bool
    """Whether the trial begins with these logs."""
    times: dict[str, str] = field(default_factory=dict)
    """key -> what is wrong with its times."""
    moves: dict[str, set[int]] = field(default_factory=dict)
    """key -> the numbers of the moves, which go on across restarts."""
    _latest_t_ns: dict[str, int] = field(default_factory=dict)

    def add(self, part: Part, log: LogIdentity) -> None:
        key, rejected = part.channel.key, 0
        if part.payloads:
            found = rows(part, log)
            rejected = len(found.rejected)
            if part.channel.topic is topics.MOVE:
                self.moves.setdefault(key, set()).update(set(found.tables[0].frame["number"]) - {0})
        self.health.add(as_one(part, log), rejected)
        self._add_times(part)

    def _add_times(self, part: Part) -> None:
        key, received = part.channel.key, part.receive_t_ns
        for t_ns in (received, part.publish_t_ns):
            if t_ns.min() < 0 or t_ns.max() > MAX_T_NS:
                self.times[key] = "times that cannot be, before the run or centuries after"
        if received[0] < self._latest_t_ns.get(key, 0) or (np.diff(received) < 0).any():
            self.times.setdefault(key, "received in another order than recorded")
        self._latest_t_ns[key] = int(received[-1])

    def damage(self) -> list[str]:
        return [f"{key}: {what}" for key, what in sorted(self.times.items())]

    def swallowed_moves(self, missing: Mapping[str, int]) -> list[str]:
        """What a restart swallowed, beyond the messages known to be missing: the trial numbers its moves."""
        counts = {key: self._span(found) - len(found) for key, found in self.moves.items() if found}
        return [
            f"{key}: {count} moves missing"
            for key, count in sorted(counts.items())
            if count > missing.get(key, 0)
        ]

    def _span(self, numbers: set[int]) -> int:
        """How many moves there should be, from the first to the last."""
        return max(numbers) - (0 if self.begins else min(numbers) - 1)


def check_log(path: Path) -> LogCheck:
    """Read every byte and decode every message; LogError for what is no log of a run.

    One of several logs of a trial is checked by itself.
    """
    about = LogReader(path)
    about.read_metadata()
    identity = identity_of(about)
    return _checked([identity], [] if identity.ending.state == CONTINUED else [identity.ending.fault])


def check_run(run: Path) -> list[LogCheck]:
    """The trials of a run directory, each with all of its logs: what is missing between them is missing."""
    logs = logs_in(run, [])
    return [_checked(parts, [*misplaced(parts, logs[0]), parts[0].ending.fault]) for parts in by_trial(logs)]


def _checked(parts: list[LogIdentity], about: list[str]) -> LogCheck:
    """`about`: why the logs as a whole are not those of a complete trial; empty texts say nothing."""
    contents = _Contents(HealthTable(parts[0]), begins=parts[0].part == 1)
    read = [_read(part, contents) for part in parts]
    readers = [reader for reader, _ in read]
    found = contents.health.frame()
    damage = [fault for each in read for fault in _damage(*each, named=len(parts) > 1)]
    damage += _unlinked(parts)
    return LogCheck(
        parts[0].path,
        sum(reader.messages for reader in readers),
        all(reader.recorded_messages is not None for reader in readers),
        [*damage, *contents.damage(), *_bad_messages(found)],
        [*filter(None, about), *_lacking(parts[0].ending, found, contents)],
        _remarks(found),
        _events(found),
        contents.health.holes(),
    )


def _read(identity: LogIdentity, contents: _Contents) -> tuple[LogReader, str]:
    """The log, read to its end, and what its hash chain says against it; empty if nothing."""
    chain = Chain(identity.first_link)
    reader = LogReader(identity.path, is_tabled, chain)
    for part in reader.parts():
        contents.add(part, identity)
    differs = identity.last_link not in ("", chain.link) and not reader.damage
    return reader, "the chunks are not those that were recorded (hash chain)" if differs else ""


def _unlinked(parts: list[LogIdentity]) -> Iterator[str]:
    """Logs that do not go on from the one before them, as far as both say so."""
    for before, after in pairwise(parts):
        known = after.part == before.part + 1 and after.first_link and before.last_link
        if known and after.first_link != before.last_link:
            yield f"{after.path.name} does not go on from {before.path.name} (hash chain)"


def _lacking(ending: Ending, health: pl.DataFrame, contents: _Contents) -> Iterator[str]:
    yield from _missing(health)
    yield from contents.swallowed_moves(dict(health.group_by("key").agg(pl.col("missing").sum()).iter_rows()))
    if ending.state == COMPLETE:
        yield from _unaccounted(health)


def _damage(reader: LogReader, by_chain: str, *, named: bool) -> list[str]:
    """Why a log is not sound by its own bytes; `named`: with the file's name."""
    found = [*map(str, reader.damage), *reader.unverified, *filter(None, [by_chain])]
    if reader.recorded_messages is None and not found:
        found.append("the log has no index")
    return [f"{printable(Path(reader.path.name))}: {fault}" for fault in found] if named else found


def _is_event() -> pl.Expr:
    return pl.col("delivery") == "every"


def _missing(health: pl.DataFrame) -> list[str]:
    return _counts(health.filter(_is_event()), "missing", "messages missing")


def _events(health: pl.DataFrame) -> int:
    events = health.filter(_is_event())
    return int((events["messages"] - events["duplicates"] + events["missing"]).sum())


def _silent(health: pl.DataFrame) -> pl.DataFrame:
    """Senders of learning events that do not say how many they sent: robot and epoch."""
    return health.filter(_is_event() & pl.col("sent").is_null()).unique(["robot", "epoch"])


def _unaccounted(health: pl.DataFrame) -> Iterator[str]:
    """Senders of learning events that do not say how many they sent. (Of a server that was killed it is known
    that it said nothing.)
    """
    silent = _silent(health).filter(pl.col("robot") != "server")
    for robot, starts in silent.group_by("robot").len().sort("robot").iter_rows():
        again = f" in {starts} starts" if starts > 1 else ""
        yield f"{robot}: gave no account of how much it sent{again}, so that its last messages may be missing"


def _bad_messages(health: pl.DataFrame) -> list[str]:
    return [
        *_counts(health, "duplicates", "duplicates"),
        *_counts(health, "rejected", "messages that cannot be decoded"),
    ]


def _remarks(health: pl.DataFrame) -> list[str]:
    totals = health_totals(health)
    remarks = _counts(health.filter(~_is_event()), "missing", "messages missing")
    remarks += [f"{key}: below half of its declared rate" for key in totals["slow_keys"]]
    remarks += [f"{key}: of a type that is not known here" for key in totals["unreadable_keys"]]
    if "server" in _silent(health)["robot"]:
        remarks.append("server: killed, and what it said itself in its last moment may be missing")
    restarted = health.filter(pl.col("restart") > 0)["robot"].unique().sort()
    return remarks + [f"{robot}: restarted during the trial" for robot in restarted]


def _counts(health: pl.DataFrame, column: str, what: str) -> list[str]:
    """A line for each key with more than none in a column."""
    counted = health.group_by("key").agg(pl.col(column).sum()).filter(pl.col(column) > 0).sort("key")
    return [f"{key}: {count} {what}" for key, count in counted.iter_rows()]
