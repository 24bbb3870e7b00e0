"""A console's server in this process, for a log."""

from __future__ import annotations

import asyncio
import socket
import threading
from http.client import HTTPConnection
from pathlib import Path

import uvicorn
from websockets.sync.client import ClientConnection, connect

from swarm.console.guard import Roles
from swarm.console.open_page import Shown
from swarm.console.page_server import page_app
from swarm.console.polling import Polling
from swarm.console.serving import Address, server_of
from swarm.console.sources import POLL_S, LogSource, Source


class Served:
    """A server of a small log in a thread of its own, on a free port or on a given one."""

    def __init__(self, log: Path, roles: Roles, port: int = 0) -> None:
        self._polling: Polling[Source] = Polling(LogSource([log]), POLL_S)
        self._address = Address(port=port)
        self._listener = self._address.listener()
        self.port = self._listener.getsockname()[1]
        names = self._address.names(self.port)
        app = page_app(Shown(self._polling), roles, names, "http")
        self._server: uvicorn.Server = server_of(app, self._address)
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        asyncio.run(self._server.serve(sockets=[self._listener]))

    def __enter__(self) -> Served:
        self._polling.__enter__()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.should_exit = True
        self._thread.join()
        self._listener.close()
        self._polling.__exit__()

    def get(self, path: str, method: str = "GET", **headers: str) -> tuple[int, dict[str, str], bytes]:
        """Status, headers and body; the headers' names with _ for -."""
        connection = HTTPConnection("127.0.0.1", self.port)
        try:
            names = {name.replace("_", "-"): value for name, value in headers.items()}
            connection.request(method, path, headers=names)
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def connect(self, origin: str | None = "", host: str = "") -> ClientConnection:
        """As the page of this server does; as another one with another origin."""
        own = f"http://127.0.0.1:{self.port}" if origin == "" else origin
        headers = {"Origin": own} if own else {}
        here = socket.create_connection(("127.0.0.1", self.port))
        address = f"ws://{host or f'127.0.0.1:{self.port}'}/run"
        return connect(address, sock=here, additional_headers=headers, max_size=None, open_timeout=None)
