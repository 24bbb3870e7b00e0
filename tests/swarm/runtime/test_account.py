"""Closing accounts: what was packed comes back, and nothing else is believed."""

from __future__ import annotations

import pytest

from swarm.runtime.account import MAX_ACCOUNT_BYTES, Account


def test_an_account_comes_back() -> None:
    account = Account({"robot/a/move": 17, "robot/a/event": 2**32 - 1}, {"run/state 7": (3, 120)})
    assert Account.unpack(account.pack()) == account


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xff",
        b"[1]",
        b'{"sent": {"robot/a/move": "1"}, "received": {}}',
        b'{"sent": {"robot/a/move": true}, "received": {}}',
        b'{"sent": {"robot/a/move": -1}, "received": {}}',
        b'{"sent": {"robot/a/move": 1e300}, "received": {}}',
        b'{"sent": {"robot/a/move": 4294967296}, "received": {}}',
        b'{"sent": {}, "received": {"run/state 7": [1]}}',
        b'{"sent": {}, "received": {"run/state 7": [1, -1]}}',
        b'{"sent": {}, "received": {"run/state 7": "12"}}',
        b'{"sent": {}, "received": []}',
        b"[" * 60_000,
        Account({"robot/a/move": 1}).pack() + b" " * MAX_ACCOUNT_BYTES,
    ],
)
def test_what_is_no_account_says_nothing(payload: bytes) -> None:
    assert Account.unpack(payload) == Account()
