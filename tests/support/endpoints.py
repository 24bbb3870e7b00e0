"""Where the servers of tests listen."""

from __future__ import annotations

import socket


def free_endpoint() -> str:
    """A port of this machine's own that nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"
