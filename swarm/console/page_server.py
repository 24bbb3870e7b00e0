"""The page, and one connection to each browser that shows it."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.routing import Mount, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from swarm.console.feed import Feed
from swarm.console.guard import Guard, Roles
from swarm.console.viewer import Viewer

PAGE = Path(__file__).parent / "page"
FRAME_S = 0.05
"""The page draws the places in between; a trial's poses come every 0.1 s."""
FRAME_OF_MANY_S = 0.1
MANY_ROBOTS = 20
"""Above this a frame takes the page longer to draw than to show."""
STATE_S = 0.5
"""A person sees no difference."""
GREETING_WITHIN_S = 5.0
MOST_VIEWERS = 32
"""A laboratory's screens; each takes a hundredth of a core."""
REFUSED = 1008
"""WebSocket's code for a breach of policy (RFC 6455, section 7.4.1)."""
NOT_UNDERSTOOD = 1003


def page_app(feed: Feed, roles: Roles, hosts: list[str], scheme: str) -> Guard:
    """The application that a server runs, for pages that are opened under one of the hosts' names."""
    connections = Connections(feed, roles)
    routes = [
        WebSocketRoute("/run", connections.serve),
        Mount("/", StaticFiles(directory=PAGE, html=True)),
    ]
    return Guard(Starlette(routes=routes), hosts, scheme)


class Connections:
    """Every page that is open now."""

    def __init__(self, feed: Feed, roles: Roles, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._feed = feed
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
        except (ValueError, KeyError, TimeoutError):
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
            page = Page(self._feed, may_steer=self._roles.may_steer(token))
            await self._talk(websocket, page)

    async def _talk(self, websocket: WebSocket, page: Page) -> None:
        hearing = asyncio.create_task(_hear(websocket, page))
        try:
            while not hearing.done():
                for message in page.messages(self._monotonic_s()):
                    await websocket.send_text(message)
                await asyncio.wait({hearing}, timeout=page.period_s)
            await hearing
        finally:
            hearing.cancel()


async def _hear(websocket: WebSocket, page: Page) -> None:
    while True:
        page.hear(await websocket.receive_json())


class Page:
    """What one open page is told, and what it asks."""

    def __init__(self, feed: Feed, *, may_steer: bool) -> None:
        self.may_steer = may_steer
        self._feed = feed
        self._viewer: Viewer | None = None
        self._now_s: float | None = None
        self._state_due_s = 0.0

    @property
    def period_s(self) -> float:
        """Between two frames."""
        history = self._feed.source.history
        return FRAME_OF_MANY_S if history and len(history.robots) > MANY_ROBOTS else FRAME_S

    def hear(self, words: Any) -> None:
        """Something that the page asks."""
        self._state_due_s = 0.0
        if self._viewer:
            with self._viewer.history.lock:
                self._viewer.asked(words)

    def messages(self, now_s: float) -> Iterator[str]:
        """What the page has to be told at a time, as JSON."""
        elapsed_s = now_s - self._now_s if self._now_s is not None else 0.0
        self._now_s = now_s
        viewer = self._viewer_of_run()
        for message in viewer.step(elapsed_s) if viewer else ():
            yield json.dumps(message, separators=(",", ":"))
        if now_s >= self._state_due_s:
            self._state_due_s = now_s + STATE_S
            yield json.dumps({**(viewer.state if viewer else {"kind": "state"}), **self._about_source()})

    def _viewer_of_run(self) -> Viewer | None:
        """A new one when another run has begun."""
        history = self._feed.source.history
        if history and (self._viewer is None or self._viewer.history is not history):
            self._viewer = Viewer(history, live=self._feed.source.is_live)
        return self._viewer

    def _about_source(self) -> dict[str, Any]:
        source = self._feed.source
        return {
            "source": self._feed.state,
            "trouble": bool(self._feed.trouble),
            "is_live": source.is_live,
            "may_steer": self.may_steer,
        }
