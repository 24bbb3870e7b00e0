"""Where a console's page is to be found: this machine alone, or an address of its own with a certificate."""

from __future__ import annotations

import ipaddress
import socket
import sys
import threading
import webbrowser
from dataclasses import dataclass
from pathlib import Path

import uvicorn
from starlette.types import ASGIApp

from swarm.console.guard import Roles, new_token
from swarm.console.open_page import Shown
from swarm.console.page_server import page_app
from swarm.errors import UserError

LOOPBACK = "127.0.0.1"
LARGEST_WORDS_BYTES = 16_384
"""Of what a page asks; the longest takes a hundred."""
LEAVE_WITHIN_S = 1
"""Pages that are still connected are left then; they come back by themselves."""


@dataclass(frozen=True)
class Address:
    """Where the page is served; anywhere but on this machine alone only with a certificate and its key."""

    host: str = LOOPBACK
    port: int = 0
    certificate: Path | None = None
    key: Path | None = None

    def check(self) -> None:
        """UserError for an address under which strangers could look or listen."""
        if self.host in ("", "0.0.0.0", "::"):
            raise UserError(f"--listen {self.host}: name the one address that pages are opened under")
        if not self.is_loopback and not (self.certificate and self.key):
            raise UserError(f"--listen {self.host}: others can reach it: give --certificate and --key, too")
        for file in filter(None, (self.certificate, self.key)):
            if not file.is_file():
                raise UserError(f"{file}: there is no such file")

    @property
    def is_loopback(self) -> bool:
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    @property
    def scheme(self) -> str:
        return "https" if self.certificate else "http"

    def names(self, port: int) -> list[str]:
        """What a browser may call this server."""
        hosts = [self.host, "localhost", LOOPBACK] if self.is_loopback else [self.host]
        return [f"{f'[{host}]' if ':' in host else host}:{port}" for host in dict.fromkeys(hosts)]

    def listener(self) -> socket.socket:
        """A socket that listens there; UserError if it cannot."""
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listener = socket.socket(family, socket.SOCK_STREAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((self.host, self.port))
            listener.listen()
        except OSError as error:
            listener.close()
            raise UserError(
                f"cannot listen on {self.host}:{self.port} ({error.strerror}): choose another --port"
            ) from error
        return listener


def serve(shown: Shown, address: Address, *, steer: bool, browse: bool) -> None:
    """Serve the page until the process is told to leave; the address to open is printed."""
    with address.listener() as listener:
        port = listener.getsockname()[1]
        roles = Roles("" if address.is_loopback else new_token(), new_token() if steer else "")
        names = address.names(port)
        _announce(f"{address.scheme}://{names[0]}/", roles, browse=browse)
        server_of(page_app(shown, roles, names, address.scheme), address).run(sockets=[listener])


def server_of(app: ASGIApp, address: Address) -> uvicorn.Server:
    """A server that says nothing of itself, and takes in no more than pages say."""
    return uvicorn.Server(
        uvicorn.Config(
            app,
            ssl_certfile=address.certificate,
            ssl_keyfile=address.key,
            ws="websockets-sansio",
            ws_max_size=LARGEST_WORDS_BYTES,
            ws_per_message_deflate=False,
            lifespan="off",
            log_level="error",
            server_header=False,
            timeout_graceful_shutdown=LEAVE_WITHIN_S,
        )
    )


def _announce(page: str, roles: Roles, *, browse: bool) -> None:
    """Print the addresses; a token stands behind the #, which a browser sends to nobody."""
    look = f"{page}#token={roles.viewer}" if roles.viewer else page
    steer = f"{page}#token={roles.operator}"
    print(f"look   {look}", flush=True)
    if roles.operator:
        print(f"steer  {steer}", flush=True)
    print("leave  with Ctrl-C", file=sys.stderr, flush=True)
    if browse:
        opened = steer if roles.operator else look
        threading.Thread(target=webbrowser.open, args=(opened,), daemon=True).start()
