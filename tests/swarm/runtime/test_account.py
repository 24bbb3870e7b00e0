"""Closing accounts: what was packed comes back, and nothing else is believed."""

from __future__ import annotations

import pytest

from swarm.runtime.account import MAX_ACCOUNT_BYTES, pack_account, unpack_account


def test_an_account_comes_back() -> None:
    sent = {"robot/a/move": 17, "robot/a/event": 2**32 - 1}
    assert unpack_account(pack_account(sent)) == sent


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xff",
        b"[1]",
        b'{"robot/a/move": "1"}',
        b'{"robot/a/move": true}',
        b'{"robot/a/move": -1}',
        b'{"robot/a/move": 1e300}',
        b'{"robot/a/move": 4294967296}',
        b"[" * 60_000,
        b'{"robot/a/move": 1' + b" " * MAX_ACCOUNT_BYTES + b"}",
    ],
)
def test_what_is_no_account_says_nothing(payload: bytes) -> None:
    assert unpack_account(payload) == {}
