"""Where the server is to be found, looked at before anything waits for it."""

from __future__ import annotations

import re
import socket

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


_FORM = "write, for instance, tcp/192.168.1.10:7447"


def _look_up(endpoint: str, host: str) -> None:
    try:
        socket.getaddrinfo(host, None)
    except (OSError, UnicodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise UserError(f"{endpoint}: host {host!r} is not known ({reason}); {_FORM}") from error
