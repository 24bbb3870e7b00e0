"""Endpoints under which nobody can be reached are refused before anything waits."""

from __future__ import annotations

import re

import pytest

from swarm.errors import UserError
from swarm.runtime.endpoint import check_endpoint, check_protection

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
    assert "tls/192.168.1.10:7447" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "endpoint", ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "tcp/localhost:65535", "unixsock-stream/here/hub"]
)
def test_a_good_endpoint_is_let_pass(endpoint: str) -> None:
    check_endpoint(endpoint)


@pytest.mark.parametrize(
    "endpoint", ["tcp/0.0.0.0:7447", "tcp/192.0.2.1:1", "udp/[::]:7447", "ws/192.0.2.1:1"]
)
def test_nothing_that_others_can_reach_is_opened_in_the_clear(endpoint: str) -> None:
    address = endpoint.partition("/")[2]
    with pytest.raises(UserError, match=f"tls/{re.escape(address)} with --credentials DIR .* --insecure"):
        check_protection(endpoint, certified=False, insecure=False)
    check_protection(endpoint, certified=False, insecure=True)


@pytest.mark.parametrize("endpoint", ["tls/127.0.0.1:7447", "quic/192.0.2.1:7447"])
def test_what_shows_certificates_needs_some(endpoint: str) -> None:
    with pytest.raises(UserError, match="needs certificates: --credentials DIR"):
        check_protection(endpoint, certified=False, insecure=True)
    check_protection(endpoint, certified=True, insecure=False)


@pytest.mark.parametrize(
    "endpoint", ["tcp/127.0.0.1:1", "tcp/localhost:1", "tcp/[::1]:1", "unixsock-stream/x"]
)
def test_one_machine_needs_no_certificates(endpoint: str) -> None:
    check_protection(endpoint, certified=False, insecure=False)
