"""Where the server is to be found, looked at before anything waits for it."""

from __future__ import annotations

import re
import socket
from ipaddress import ip_address

from swarm.errors import UserError

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
"""Of a server on this machine, at the port that Zenoh has registered."""
PROTOCOLS = ("tcp", "tls", "quic", "udp", "ws")
"""Over a network; on one machine there is `unixsock-stream/FILE` too."""
_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:.%]+\]|[^/:\[\]]+):(\d+)([?#].*)?")


def check_endpoint(endpoint: str) -> None:
    """UserError if nobody can be reached under an endpoint, whoever listens: its form, its port, its host.

    A host's name is looked up, which may take as long as the network likes.
    """
    protocol, _, address = endpoint.partition("/")
    if protocol == "unixsock-stream" and address:
        return
    if protocol not in PROTOCOLS:
        raise UserError(f"{endpoint}: {protocol!r} is none of {', '.join(PROTOCOLS)}; {_FORM}")
    found = _ADDRESS.fullmatch(address)
    if not found:
        raise UserError(f"{endpoint}: {address!r} is no HOST:PORT; {_FORM}")
    if not 1 <= int(found[2]) <= 65_535:
        raise UserError(f"{endpoint}: the port is none from 1 to 65535; {_FORM}")
    _look_up(endpoint, found[1].strip("[]"))


def check_protection(endpoint: str, certified: bool, insecure: bool) -> None:
    """UserError if an endpoint, whose form is checked, would let anybody on the network take part.

    `certified` says that there are certificates, which TLS alone can show.
    """
    protocol, _, address = endpoint.partition("/")
    if protocol in ENCRYPTED:
        if not certified:
            raise UserError(f"{endpoint}: {protocol} needs certificates: --credentials DIR, {_MADE}")
    elif protocol != "unixsock-stream" and not insecure and not is_loopback(address):
        raise UserError(
            f"{endpoint}: whoever reaches it can hear and say everything: write tls/{address} with "
            f"--credentials DIR ({_MADE}), or --insecure on a network of your own"
        )


ENCRYPTED = ("tls", "quic")
"""What asks for certificates."""
_MADE = "as `swarm lab keys LAB.toml` makes them"
_FORM = "write, for instance, tls/192.168.1.10:7447"


def is_loopback(address: str) -> bool:
    """Whether only this machine reaches a HOST:PORT, by all addresses that the host has."""
    host = address.partition("?")[0].rpartition(":")[0].strip("[]")
    return all(ip_address(found[4][0]).is_loopback for found in socket.getaddrinfo(host, None))


def _look_up(endpoint: str, host: str) -> None:
    try:
        socket.getaddrinfo(host, None)
    except (OSError, UnicodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise UserError(f"{endpoint}: host {host!r} is not known ({reason}); {_FORM}") from error
