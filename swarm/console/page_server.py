"""The page, and one connection to each browser that shows it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from pathlib import Path

from starlette.applications import Starlette
from starlette.routing import Mount, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from swarm.console.guard import Guard, Roles
from swarm.console.open_page import OpenPage, Shown

PAGE = Path(__file__).parent / "page"
GREETING_WITHIN_S = 5.0
MOST_VIEWERS = 32
"""A laboratory's screens; each takes a hundredth of a core."""
REFUSED = 1008
"""WebSocket's code for a breach of policy (RFC 6455, section 7.4.1)."""
NOT_UNDERSTOOD = 1003


def page_app(shown: Shown, roles: Roles, hosts: list[str], scheme: str) -> Guard:
    """The application that a server runs, for pages that are opened under one of the hosts' names."""
    connections = Connections(shown, roles)
    routes = [
        WebSocketRoute("/run", connections.serve),
        Mount("/", StaticFiles(directory=PAGE, html=True)),
    ]
    return Guard(Starlette(routes=routes), hosts, scheme)


class Connections:
    """Every page that is open now."""

    def __init__(self, shown: Shown, roles: Roles, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._shown = shown
        self._roles = roles
        self._monotonic_s = monotonic_s
        self._open = 0

    async def serve(self, websocket: WebSocket) -> None:
        """One page, from its greeting until it goes."""
        await websocket.accept()
        self._open += 1
        try:
            await self._serve(websocket)
        except WebSocketDisconnect:
            return
        except (ValueError, KeyError, RecursionError, TimeoutError):
            await websocket.close(NOT_UNDERSTOOD, "not what a page of this console says")
        finally:
            self._open -= 1

    async def _serve(self, websocket: WebSocket) -> None:
        greeting = await asyncio.wait_for(websocket.receive_json(), GREETING_WITHIN_S)
        token = str(greeting.get("token", "")) if isinstance(greeting, dict) else ""
        if not self._roles.may_look(token):
            await websocket.close(REFUSED, "the token is missing or wrong: open the address that was printed")
        elif self._open > MOST_VIEWERS:
            await websocket.close(REFUSED, f"{MOST_VIEWERS} pages are open already: close one")
        else:
            await self._talk(websocket, OpenPage(self._shown, may_steer=self._roles.may_steer(token)))

    async def _talk(self, websocket: WebSocket, page: OpenPage) -> None:
        hearing = asyncio.create_task(_hear(websocket, page))
        try:
            while not hearing.done():
                for message in page.messages(self._monotonic_s()):
                    await websocket.send_text(message)
                await asyncio.wait({hearing}, timeout=page.period_s)
            await hearing
        finally:
            hearing.cancel()


async def _hear(websocket: WebSocket, page: OpenPage) -> None:
    """Orders are waited for on a thread: meanwhile the page goes on, and may say more."""
    orders: set[asyncio.Task[None]] = set()
    while True:
        words = await websocket.receive_json()
        if page.is_order(words):
            order = asyncio.create_task(asyncio.to_thread(page.order, words))
            orders.add(order)
            order.add_done_callback(orders.discard)
        else:
            page.hear(words)
