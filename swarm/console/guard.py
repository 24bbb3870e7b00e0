"""Who may talk to the page's server: only browsers that show its own page, under its own name.

Another site's page that a person has open can send requests to this machine, also under a name that it lets
point here (DNS rebinding). So the names (`Host`) and the page that asks (`Origin`) are compared.
"""

from __future__ import annotations

import secrets
from collections.abc import Collection
from dataclasses import dataclass

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOKEN_BYTES = 16
"""Nobody guesses 128 bits."""
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}
"""Nothing from elsewhere is loaded, nothing is run but files of ours, nobody frames us."""


@dataclass(frozen=True)
class Roles:
    """What a page may do, by the token that it shows."""

    viewer: str = ""
    """Empty: everybody who reaches the page may look."""
    operator: str = ""
    """Empty: nobody may steer."""

    def may_steer(self, token: str) -> bool:
        return bool(self.operator) and _same(token, self.operator)

    def may_look(self, token: str) -> bool:
        return not self.viewer or _same(token, self.viewer) or self.may_steer(token)


def new_token() -> str:
    """A secret for a page's address."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def _same(one: str, other: str) -> bool:
    return secrets.compare_digest(one.encode(), other.encode())


class Guard:
    """Refuses what does not come from this server's own page, and tells browsers what that page may do."""

    def __init__(self, app: ASGIApp, hosts: Collection[str], scheme: str) -> None:
        self._app = app
        self._hosts = frozenset(hosts)
        self._origins = {f"{scheme}://{host}" for host in hosts}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        reason = self._reason_against(scope)
        if not reason:
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": reason})
        else:
            await PlainTextResponse(f"refused: {reason}", 403)(scope, receive, _with_headers(send))

    def _reason_against(self, scope: Scope) -> str:
        headers = Headers(scope=scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if len(headers.getlist("host")) != 1 or host not in self._hosts:
            return "this server has another name; open the address that it printed"
        if origin is None and scope["type"] == "websocket":
            return "a connection has to say which page asks"
        if origin is not None and origin not in self._origins:
            return "another site's page asks"
        if scope["type"] == "http" and scope["method"] not in ("GET", "HEAD"):
            return "there is nothing here that a form could send"
        return ""


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).update(HEADERS)
        await send(message)

    return sending
