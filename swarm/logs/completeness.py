"""How complete a log is: for each key and each start of its sender, what was seen and what is missing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from swarm.logs.identity import LogIdentity
from swarm.logs.reader import LogChannel, Part
from swarm.messages.topics import topic_of

_S_PER_NS = 1e-9
_SCHEMA: dict[str, Any] = {
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
    "missing": pl.Int64,
    "gaps": pl.Int64,
    "duplicates": pl.Int64,
    "out_of_order": pl.Int64,
    "rejected": pl.Int64,
    "readable": pl.Boolean,
}


@dataclass
class HealthTable:
    """Fills from the parts of one log; needs no payload."""

    identity: LogIdentity
    _sequences: dict[LogChannel, list[npt.NDArray[np.uint32]]] = field(default_factory=dict)
    _times: dict[LogChannel, list[npt.NDArray[np.int64]]] = field(default_factory=dict)
    _rejected: dict[LogChannel, int] = field(default_factory=dict)

    def add(self, part: Part, rejected: int = 0) -> None:
        """Count a part, and how many of its messages could not be decoded."""
        self._sequences.setdefault(part.channel, []).append(part.sequence.astype(np.uint32))
        self._times.setdefault(part.channel, []).append(part.publish_t_ns)
        self._rejected[part.channel] = self._rejected.get(part.channel, 0) + rejected

    def frame(self) -> pl.DataFrame:
        """A row for each key and epoch, in order; `restart` counts a key's epochs from 0.

        `missing` messages lie between the first and the last number seen, in `gaps` stretches; what a
        sender sent before the recorder heard it shows as a `first_sequence` above 1.
        """
        channels = sorted(self._sequences, key=lambda channel: (channel.key, channel.epoch, channel.id))
        restarts: dict[str, int] = {}
        found = []
        for channel in channels:
            restart = restarts[channel.key] = restarts.get(channel.key, -1) + 1
            found.append(self._row(channel) | {"restart": restart})
        return pl.DataFrame([{name: row[name] for name in _SCHEMA} for row in found], schema=_SCHEMA)

    def _row(self, channel: LogChannel) -> dict[str, Any]:
        topic = topic_of(channel.key)
        return {
            "log": str(self.identity.path),
            "seed": self.identity.seed,
            "trial": self.identity.trial,
            "key": channel.key,
            "robot": channel.publisher,
            "delivery": topic[0].delivery.value if topic else "",
            "epoch": channel.epoch,
            "declared_hz": topic[0].rate_hz if topic else None,
            "rejected": self._rejected[channel],
            "readable": channel.topic is not None or channel.is_for_viewers,
            **_numbers(np.concatenate(self._sequences[channel])),
            **_rates(np.concatenate(self._times[channel])),
        }


def _numbers(sequence: npt.NDArray[np.uint32]) -> dict[str, int]:
    """What the sequence numbers, in the order of the log, tell."""
    once = np.unique(sequence).astype(np.int64)
    steps = np.diff(once)
    return {
        "messages": len(sequence),
        "first_sequence": int(once[0]),
        "last_sequence": int(once[-1]),
        "missing": int((steps - 1).sum()),
        "gaps": int((steps > 1).sum()),
        "duplicates": len(sequence) - len(once),
        "out_of_order": int((np.diff(sequence.astype(np.int64)) < 0).sum()),
    }


def _rates(publish_t_ns: npt.NDArray[np.int64]) -> dict[str, float | None]:
    """The mean rate from the first to the last message, and the longest time without one."""
    lasted_s = float(np.ptp(publish_t_ns.astype(np.float64))) * _S_PER_NS
    if lasted_s <= 0:
        return {"seen_hz": None, "longest_silence_s": None}
    silence_s = float(np.diff(np.sort(publish_t_ns)).max()) * _S_PER_NS
    return {"seen_hz": (len(publish_t_ns) - 1) / lasted_s, "longest_silence_s": silence_s}


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
