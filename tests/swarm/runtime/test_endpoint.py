"""Endpoints under which nobody can be reached are refused before anything waits."""

from __future__ import annotations

import pytest

from swarm.errors import UserError
from swarm.runtime.endpoint import check_endpoint

BAD = {
    "http/127.0.0.1:80": "'http' is none of",
    "tcp/127.0.0.1": "no HOST:PORT",
    "tcp/:7447": "no HOST:PORT",
    "127.0.0.1:7447": "none of tcp",
    "": "none of tcp",
    "tcp/127.0.0.1:99999": "port is none from 1 to 65535",
    "tcp/127.0.0.1:0": "port is none from 1 to 65535",
    "tcp/127.0.0.1:seven": "no HOST:PORT",
    "tcp/no-such-host.invalid:7447": "host 'no-such-host.invalid' is not known",
    "tcp/" + "a" * 70 + ":7447": "is not known",
    "unixsock-stream/": "none of tcp",
}


@pytest.mark.parametrize("endpoint", BAD)
def test_a_bad_endpoint_is_refused_with_its_fault_and_a_good_one(endpoint: str) -> None:
    with pytest.raises(UserError, match=BAD[endpoint]) as refused:
        check_endpoint(endpoint)
    assert str(refused.value).startswith(f"{endpoint}: ")
    assert "tcp/192.168.1.10:7447" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "endpoint", ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "tcp/localhost:65535", "unixsock-stream/here/hub"]
)
def test_a_good_endpoint_is_let_pass(endpoint: str) -> None:
    check_endpoint(endpoint)
