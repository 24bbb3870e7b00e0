"""Where the numbers of a page come from: which logs, which keys, which moves, and what was done with them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from swarm.logs.identity import LogIdentity
from swarm.messages.topics import Topic

Cell = Any
"""Of a table: a text, a number with its source (`Sources.number`), or a list of these side by side."""


@dataclass
class Sources:
    """The logs of a page and, each once, the sources of its numbers."""

    logs: Sequence[LogIdentity]
    listed: list[dict[str, Any]] = field(default_factory=list)

    def number(self, value: float | None, text: str, source: int) -> Cell:
        """A number as a page holds it: its exact value, what is shown of it, and where it comes from."""
        finite = value if value is not None and math.isfinite(value) else None
        return {"value": finite, "text": text, "source": source}

    def of(
        self, logs: Iterable[int], keys: Iterable[str], how: str, moves: tuple[int, int] | None = None
    ) -> int:
        """The number of a source: logs by their places, and what was done with what they hold."""
        said = {"logs": sorted(set(logs)), "keys": sorted(set(keys)), "how": how}
        source = said | {"moves": None if moves is None else list(moves)}
        if source not in self.listed:
            self.listed.append(source)
        return self.listed.index(source)

    def of_condition(self, condition: str) -> list[int]:
        """The logs in which somebody learnt under a condition."""
        return [
            place
            for place, log in enumerate(self.logs)
            if any(log.conditions[robot] == condition for robot in log.learners)
        ]

    def keys_of_condition(self, condition: str, topic: Topic[Any]) -> set[str]:
        """The keys of its learners."""
        return {
            topic.key(robot)
            for log in self.logs
            for robot in log.learners
            if log.conditions[robot] == condition
        }

    def of_trial(self, trial_log: str) -> list[int]:
        """All logs of a trial, by the name that tables give it."""
        return [place for place, log in enumerate(self.logs) if log.trial_log == trial_log]

    def all_logs(self) -> range:
        return range(len(self.logs))
