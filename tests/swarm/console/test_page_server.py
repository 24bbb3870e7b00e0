"""The page's server, over real sockets: what it serves, and everything that it refuses."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from swarm.console.controls import ORDERS
from swarm.console.guard import Roles
from swarm.console.page_server import PAGE
from swarm.console.serving import Address
from swarm.errors import UserError
from tests.support.console_server import Served
from tests.support.learnt_logs import ROBOT, learnt_log

TOKEN = "look-" + "0" * 16
RESET = 0
"""The server closes without reading on: what it says last may be lost with what is on its way."""
OPERATOR = "steer-" + "1" * 16


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("served") / "trial-000.mcap"
    learnt_log(path, 80)
    return path


@pytest.fixture(scope="module")
def served(log: Path) -> Iterator[Served]:
    with Served(log, Roles()) as server:
        yield server


@pytest.fixture(scope="module")
def guarded(log: Path) -> Iterator[Served]:
    with Served(log, Roles(TOKEN, OPERATOR)) as server:
        yield server


def said(page: ClientConnection, kind: str) -> dict[str, Any]:
    """The next message of a kind."""
    while True:
        message: dict[str, Any] = json.loads(page.recv())
        if message["kind"] == kind:
            return message


def test_the_page_comes_whole_and_loads_nothing_from_elsewhere(served: Served) -> None:
    status, headers, body = served.get("/")
    assert status == 200
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    for name in re.findall(r'(?:src|href)="([^"]+)"', body.decode()):
        status, headers, _ = served.get(f"/{name}")
        assert status == 200, name
        assert headers["x-content-type-options"] == "nosniff"


def test_every_module_that_a_module_imports_is_served(served: Served) -> None:
    for module in PAGE.glob("*.js"):
        for name in re.findall(r'from "\./([\w.]+)"', module.read_text()):
            status, headers, _ = served.get(f"/{name}")
            assert status == 200, name
            assert "javascript" in headers["content-type"]


def test_no_module_makes_markup_out_of_words() -> None:
    """What a log says becomes text: nothing that could parse it as HTML or run it is used."""
    forbidden = ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "Function(")
    for module in PAGE.glob("*.js"):
        text = module.read_text()
        assert [word for word in forbidden if word in text] == [], module.name
    assert not re.search(
        r"(<script>|\son\w+=|style=|javascript:|https?://(?!www\.w3))", (PAGE / "index.html").read_text()
    )


def test_a_page_plays_the_log(served: Served) -> None:
    with served.connect() as page:
        page.send("{}")
        assert said(page, "about")["robots"][0]["id"]
        while said(page, "state")["source"] != "the whole log is read":
            pass
        page.send(json.dumps({"ask": "move", "robot": ROBOT, "number": 50}))
        while (frame := said(page, "frame"))["robots"][ROBOT]["moves"] != 50:
            assert frame
        assert len(said(page, "learner")["q_table"]) == 800


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "[::1]", ""])
def test_another_name_is_refused_as_by_dns_rebinding(served: Served, host: str) -> None:
    assert served.get("/", Host=host)[0] == 403
    with pytest.raises(InvalidStatus, match="403"):
        served.connect(host=host or "evil.example")


@pytest.mark.parametrize("origin", ["https://evil.example", "http://127.0.0.1:1", "null", None])
def test_another_site_s_page_is_refused(served: Served, origin: str | None) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        served.connect(origin)
    if origin:
        assert served.get("/", Origin=origin)[0] == 403


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_nothing_can_be_sent_by_a_form(served: Served, method: str) -> None:
    assert served.get("/run", method)[0] == 403


@pytest.mark.parametrize(
    "path", ["/../page_server.py", "/%2e%2e/page_server.py", "/..%2fguard.py", "//etc/passwd"]
)
def test_no_other_file_is_served(served: Served, path: str) -> None:
    assert served.get(path)[0] == 404


def closed(page: ClientConnection) -> int:
    """The code with which the server closes."""
    try:
        while True:
            page.recv()
    except ConnectionClosed as error:
        return error.rcvd.code if error.rcvd else RESET


@pytest.mark.parametrize(
    ("letters", "codes"),
    [(20_000, {1009}), (1_000_000, {1009, RESET})],
    ids=["a little too large", "far too large"],
)
def test_a_giant_message_closes_the_connection_and_no_other(
    served: Served, letters: int, codes: set[int]
) -> None:
    with served.connect() as other:
        other.send("{}")
        with served.connect() as page:
            page.send("{}")
            page.send("x" * letters)
            assert closed(page) in codes
        assert said(other, "state")


@pytest.mark.parametrize("words", ["{", b"\xff\xfe", "[" * 5_000])
def test_what_is_no_json_closes_the_connection(served: Served, words: str | bytes) -> None:
    with served.connect() as page:
        page.send("{}")
        page.send(words)
        assert closed(page) == 1003


@pytest.mark.parametrize("token", ["", "wrong", 5, None, ["x"]])
def test_without_the_token_nobody_looks(guarded: Served, token: Any) -> None:
    with guarded.connect() as page:
        page.send(json.dumps({"token": token}))
        assert closed(page) == 1008


@pytest.mark.parametrize("order", ORDERS)
def test_a_viewer_cannot_steer(guarded: Served, order: str) -> None:
    with guarded.connect() as page:
        page.send(json.dumps({"token": TOKEN}))
        assert said(page, "state")["may_steer"] is False
        page.send(json.dumps({"ask": "order", "order": order, "robots": [], "prompt": 0}))
        answer = said(page, "answer")
        assert not answer["accepted"]
        assert "may look, not steer" in answer["text"]


def test_roles_are_told_apart_by_whole_tokens() -> None:
    roles = Roles(TOKEN, OPERATOR)
    assert roles.may_look(TOKEN)
    assert not roles.may_steer(TOKEN)
    assert roles.may_look(OPERATOR)
    assert roles.may_steer(OPERATOR)
    for token in (TOKEN[:-1], "", TOKEN + "0", "\u0130"):
        assert not roles.may_look(token)
    assert Roles().may_look("")
    assert not Roles().may_steer("")


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        (Address("0.0.0.0"), "name the one address"),
        (Address("192.0.2.7"), "give --certificate"),
        (Address("lab.example", certificate=Path("c.pem")), "give --certificate"),
        (Address("127.0.0.1", certificate=Path("nowhere.pem"), key=Path("k.pem")), "no such file"),
    ],
)
def test_others_are_let_in_only_with_a_certificate(address: Address, reason: str) -> None:
    with pytest.raises(UserError, match=reason):
        address.check()
