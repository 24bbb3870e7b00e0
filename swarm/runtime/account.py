"""The closing account: as a process leaves it says how many messages of each key it has sent.

Without it nobody can tell whether the last messages of a sender have arrived.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

MAX_ACCOUNT_BYTES = 65_536
"""Some hundred keys of 32 characters each take a tenth of it."""
_MAX_NUMBER = 2**32 - 1
"""A log keeps 32 bits of a number."""


def pack_account(sent: Mapping[str, int]) -> bytes:
    """Key -> the number of its last message, as JSON."""
    return json.dumps(dict(sent), sort_keys=True).encode()


def unpack_account(payload: bytes) -> dict[str, int]:
    """Key -> the number of its last message; empty if the bytes are no account."""
    if len(payload) > MAX_ACCOUNT_BYTES:
        return {}
    try:
        found = json.loads(payload)
    except (ValueError, RecursionError):
        return {}
    if not isinstance(found, dict) or not all(_is_number(number) for number in found.values()):
        return {}
    return found


def _is_number(value: object) -> bool:
    return type(value) is int and 0 < value <= _MAX_NUMBER
