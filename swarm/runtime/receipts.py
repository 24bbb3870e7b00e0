"""What a process has received: messages and bytes by key and by the start of whoever sent them.

Everything that arrives counts, believed or not. A run's audit adds it up: what the hub let through is what
counts, not what the recipient made of it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

Counts = Mapping[str, tuple[int, int]]
"""KEY and EPOCH, with a space between -> messages and bytes."""


class Receipts:
    """Counts what arrives."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, int], list[int]] = {}

    def heard(self, key: str, epoch: int, payload: bytes) -> None:
        """A message has come; `epoch` is 0 if it does not say whose it is."""
        counted = self._counts.get((key, epoch))
        if counted is None:
            counted = self._counts[key, epoch] = [0, 0]
        counted[0] += 1
        counted[1] += len(payload)

    @property
    def keys(self) -> set[str]:
        """Every key of which a message was received."""
        return {key for key, _ in self._counts}

    def counts(self) -> Counts:
        """All of it, as JSON can hold it."""
        return {f"{key} {epoch}": (count, size) for (key, epoch), (count, size) in self._counts.items()}


def write_receipts(file: Path, names: list[str], received: Receipts) -> None:
    """What the process of these robots has received, for those who audit a simulated run."""
    found = {"robots": names, "received": received.counts()}
    file.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def read_receipts(file: Path) -> tuple[tuple[str, ...], Counts]:
    """Robots, and what their process has received; ValueError if the file is of something else."""
    found = json.loads(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise ValueError("no account of what was received")
    return tuple(map(str, found.get("robots", ()))), counts_of(found.get("received"))


def counts_of(found: object) -> Counts:
    """Counts that came through JSON; ValueError if it holds something else."""
    if not isinstance(found, dict):
        raise ValueError("no counts of messages")
    return {str(name): _pair(value) for name, value in found.items()}


def _pair(value: object) -> tuple[int, int]:
    if not isinstance(value, Iterable):
        raise ValueError(f"{value!r} is not two counts")
    count, size = value
    if type(count) is not int or type(size) is not int or count < 0 or size < 0:
        raise ValueError(f"{value!r} is not two counts")
    return count, size
