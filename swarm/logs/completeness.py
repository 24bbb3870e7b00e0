"""How complete a log is: for each key and each start of its sender, what was seen and what is missing.

A sender numbers its messages of a key from 1. So every number up to the last must be there; the last one is
what the sender says in its closing account, and without one at least the last that was seen. A log that goes
on from others is asked for what comes after them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from swarm.logs.ending import COMPLETE, Sender
from swarm.logs.identity import LogIdentity
from swarm.logs.reader import S_PER_NS, LogChannel, Part
from swarm.messages.topics import Delivery, topic_of

HEALTH_SCHEMA: dict[str, Any] = {
    "log": pl.String,
    "seed": pl.Int64,
    "trial": pl.Int64,
    "key": pl.String,
    "robot": pl.String,
    "delivery": pl.String,
    "epoch": pl.Int64,
    "restart": pl.Int64,
    "messages": pl.Int64,
    "declared_hz": pl.Float64,
    "seen_hz": pl.Float64,
    "longest_silence_s": pl.Float64,
    "first_sequence": pl.Int64,
    "last_sequence": pl.Int64,
    "sent": pl.Int64,
    "missing": pl.Int64,
    "gaps": pl.Int64,
    "duplicates": pl.Int64,
    "out_of_order": pl.Int64,
    "rejected": pl.Int64,
    "readable": pl.Boolean,
}


@dataclass(frozen=True)
class Hole:
    """Messages of a sender that are missing: numbers `first` to `last`."""

    key: str
    epoch: int
    first: int
    last: int
    after_t_ns: int | None
    """When the message before was sent; None if there is none."""
    before_t_ns: int | None
    """When the next one was sent; None if there is none."""

    def __str__(self) -> str:
        after = "the beginning" if self.after_t_ns is None else f"{self.after_t_ns * S_PER_NS:.3f} s"
        before = "the end" if self.before_t_ns is None else f"{self.before_t_ns * S_PER_NS:.3f} s"
        numbers = str(self.first) if self.first == self.last else f"{self.first} to {self.last}"
        return f"{self.key}: {numbers}, between {after} and {before}"


@dataclass
class HealthTable:
    """Fills from the parts of a trial's log, or of all its logs; needs no payload."""

    identity: LogIdentity
    _sequences: dict[LogChannel, list[npt.NDArray[np.uint32]]] = field(default_factory=dict)
    _times: dict[LogChannel, list[npt.NDArray[np.int64]]] = field(default_factory=dict)
    _rejected: dict[LogChannel, int] = field(default_factory=dict)

    @property
    def _sent(self) -> Mapping[Sender, int]:
        return self.identity.ending.sent

    def add(self, part: Part, rejected: int = 0) -> None:
        """Count a part, and how many of its messages could not be decoded."""
        self._sequences.setdefault(part.channel, []).append(part.sequence.astype(np.uint32))
        self._times.setdefault(part.channel, []).append(part.publish_t_ns)
        self._rejected[part.channel] = self._rejected.get(part.channel, 0) + rejected

    def frame(self) -> pl.DataFrame:
        """A row for each key and epoch, in order; `restart` counts a key's epochs from 0.

        `sent` is the last number by the sender's own account, null if it gave none. `missing` messages, in
        `gaps` stretches, are those from 1 (or from where the trial's logs before this one end) to the last.
        """
        channels = sorted(self._all_channels(), key=lambda channel: (channel.key, channel.epoch, channel.id))
        restarts: dict[str, int] = {}
        found = []
        for channel in channels:
            restart = restarts[channel.key] = restarts.get(channel.key, -1) + 1
            found.append(self._row(channel) | {"restart": restart})
        return pl.DataFrame(
            [{name: row[name] for name in HEALTH_SCHEMA} for row in found], schema=HEALTH_SCHEMA
        )

    def holes(self) -> list[Hole]:
        """Where messages are missing that must not be lost."""
        return [
            hole
            for channel in sorted(self._all_channels(), key=lambda channel: (channel.key, channel.epoch))
            if (topic := topic_of(channel.key)) and topic[0].delivery is Delivery.EVERY
            for hole in self._holes_of(channel)
        ]

    def _holes_of(self, channel: LogChannel) -> Iterator[Hole]:
        sender = (channel.key, channel.epoch)
        numbers = np.concatenate(self._sequences.get(channel, [np.empty(0, dtype=np.uint32)]))
        once, places = np.unique(numbers, return_index=True)
        t_ns = np.concatenate(self._times.get(channel, [np.empty(0, dtype=np.int64)]))[places]
        edge = max(self.identity.before.get(sender, 0), self._sent.get(sender, 0), *once[-1:].tolist(), 0) + 1
        known = [self.identity.before.get(sender, 0), *once.tolist(), edge]
        times: list[int | None] = [None, *t_ns.tolist(), None]
        for place in np.flatnonzero(np.diff(known) > 1).tolist():
            first, last = known[place] + 1, known[place + 1] - 1
            yield Hole(*sender, first, last, times[place], times[place + 1])

    def _all_channels(self) -> list[LogChannel]:
        """Those seen, and those of which a sender says that they should have been."""
        seen = {(channel.key, channel.epoch) for channel in self._sequences}
        before = self.identity.before
        unseen = [
            sender
            for sender, last in self._sent.items()
            if last > before.get(sender, 0) and sender not in seen
        ]
        return [*self._sequences, *(LogChannel(0, key, epoch, "", "") for key, epoch in unseen)]

    def _row(self, channel: LogChannel) -> dict[str, Any]:
        topic = topic_of(channel.key)
        sender = (channel.key, channel.epoch)
        sent = self._sent.get(sender)
        none = [np.empty(0, dtype=np.uint32)]
        return {
            "log": self.identity.trial_log,
            "seed": self.identity.seed,
            "trial": self.identity.trial,
            "key": channel.key,
            "robot": channel.publisher,
            "delivery": topic[0].delivery.value if topic else "",
            "epoch": channel.epoch,
            "declared_hz": topic[0].rate_hz if topic else None,
            "rejected": self._rejected.get(channel, 0),
            "readable": channel.topic is not None or channel.is_for_viewers or channel.id == 0,
            "sent": sent,
            **_numbers(
                np.concatenate(self._sequences.get(channel, none)),
                self.identity.before.get(sender, 0),
                sent or 0,
            ),
            **_rates(np.concatenate(self._times.get(channel, [np.empty(0, dtype=np.int64)]))),
        }


def _numbers(sequence: npt.NDArray[np.uint32], before: int, sent: int) -> dict[str, int | None]:
    """What sequence numbers, in the order of the log, tell; those from `before` to `sent` must be there."""
    once = np.unique(sequence).astype(np.int64)
    last = max(before, sent, int(once[-1]) if len(once) else 0)
    steps = np.diff(once, prepend=before, append=last + 1)
    return {
        "messages": len(sequence),
        "first_sequence": int(once[0]) if len(once) else None,
        "last_sequence": int(once[-1]) if len(once) else None,
        "missing": int(np.maximum(steps - 1, 0).sum()),
        "gaps": int((steps > 1).sum()),
        "duplicates": len(sequence) - len(once),
        "out_of_order": int((np.diff(sequence.astype(np.int64)) < 0).sum()),
    }


def _rates(publish_t_ns: npt.NDArray[np.int64]) -> dict[str, float | None]:
    """The mean rate from the first to the last message, and the longest time without one."""
    lasted_s = float(np.ptp(publish_t_ns.astype(np.float64))) * S_PER_NS if len(publish_t_ns) else 0.0
    if lasted_s <= 0:
        return {"seen_hz": None, "longest_silence_s": None}
    silence_s = float(np.diff(np.sort(publish_t_ns)).max()) * S_PER_NS
    return {"seen_hz": (len(publish_t_ns) - 1) / lasted_s, "longest_silence_s": silence_s}


def log_state(health: pl.DataFrame, identity: LogIdentity, damaged: bool) -> str:
    """In a word: damaged, recovered, interrupted, unfinished, incomplete, or complete."""
    ending = identity.ending
    if damaged:
        return "damaged"
    if ending.lost:
        return "recovered"
    if ending.state != COMPLETE:
        return ending.state or "unfinished"
    events = health.filter((pl.col("log") == identity.trial_log) & (pl.col("delivery") == "every"))
    accounted = events["missing"].sum() == 0 and events["sent"].null_count() == 0
    return "complete" if accounted else "incomplete"


LOW_SHARE = 0.5
"""A key is slow if it was seen at less than this share of its declared rate."""


def health_totals(health: pl.DataFrame) -> dict[str, Any]:
    """Over all keys of all logs; `missing_events` only where nothing may be lost (learning, orders)."""
    every = health.filter(pl.col("delivery") == "every")
    slow = health.filter(pl.col("seen_hz") < LOW_SHARE * pl.col("declared_hz"))
    return {
        "missing": int(health["missing"].sum()),
        "missing_events": int(every["missing"].sum()),
        "duplicates": int(health["duplicates"].sum()),
        "restarts": int((health["restart"] > 0).sum()),
        "rejected": int(health["rejected"].sum()),
        "slow_keys": slow["key"].unique().sort().to_list(),
        "unreadable_keys": health.filter(~pl.col("readable"))["key"].unique().sort().to_list(),
    }
