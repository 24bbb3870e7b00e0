"""The closing account: as a process leaves it says how many messages it has sent and received, key by key.

Without it nobody can tell whether the last messages of a sender have arrived, nor what reached a robot.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field

from swarm.runtime.receipts import Counts, counts_of

MAX_ACCOUNT_BYTES = 65_536
"""Some hundred keys of 32 characters each take a quarter of it."""
_MAX_NUMBER = 2**32 - 1
"""A log keeps 32 bits of a number."""


@dataclass(frozen=True)
class Account:
    """What a process has sent (key -> the number of its last message) and received."""

    sent: Mapping[str, int] = field(default_factory=dict)
    received: Counts = field(default_factory=dict)

    def pack(self) -> bytes:
        """As JSON, for the wire."""
        return json.dumps({"sent": dict(self.sent), "received": dict(self.received)}, sort_keys=True).encode()

    @classmethod
    def unpack(cls, payload: bytes) -> Account:
        """An account of nothing if the bytes are no account."""
        if len(payload) > MAX_ACCOUNT_BYTES:
            return cls()
        try:
            found = json.loads(payload)
            sent, received = found["sent"], counts_of(found["received"])
        except (KeyError, RecursionError, TypeError, ValueError):
            return cls()
        if not isinstance(sent, dict) or not all(_is_number(number) for number in sent.values()):
            return cls()
        return cls(sent, received)


def _is_number(value: object) -> bool:
    return type(value) is int and 0 < value <= _MAX_NUMBER
