"""The bus over real sockets: a hub, its clients, and what may get lost."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue

import pytest

from swarm.errors import UserError
from swarm.messages.topics import Delivery
from swarm.runtime.zenoh_session import (
    LARGEST_MESSAGE_BYTES,
    NEWEST_KEPT,
    Inbox,
    Publisher,
    Session,
    SessionSettings,
)
from tests.support.endpoints import free_endpoint

WAKE_S = 0.02


@pytest.fixture
def endpoint() -> str:
    return free_endpoint()


@pytest.fixture
def hub(endpoint: str) -> Iterator[Session]:
    with Session(SessionSettings(endpoint, hub=True)) as session:
        yield session


@pytest.fixture
def client(hub: Session, endpoint: str) -> Iterator[Session]:  # noqa: ARG001
    with Session(SessionSettings(endpoint)) as session:
        yield session


class Arrivals:
    """Lets a test wait until something came under a key, or for a moment if nothing does."""

    def __init__(self, session: Session, key: str) -> None:
        self._payloads: SimpleQueue[bytes] = SimpleQueue()
        session.on_arrival(key, self._payloads.put)

    def wait(self) -> None:
        with suppress(Empty):
            self._payloads.get(timeout=WAKE_S)


def introduced(publisher: Publisher, inbox: Inbox, wake: Arrivals) -> None:
    """Put until the route stands: what is sent right after declaring may be lost."""
    publisher.put(b"hello")
    while not inbox.poll():
        wake.wait()
        publisher.put(b"hello")


def drained(publisher: Publisher, inbox: Inbox, wake: Arrivals, last: bytes) -> list[bytes]:
    """Everything up to a last payload, which is put here."""
    publisher.put(last)
    found: list[bytes] = []
    while last not in found:
        wake.wait()
        found += [sample.payload for sample in inbox.poll()]
    return [payload for payload in found if payload != b"hello"]


def test_every_payload_arrives_in_order_with_what_is_beside_it(hub: Session, client: Session) -> None:
    inbox = hub.inbox("robot/*/move", Delivery.EVERY)
    wake = Arrivals(hub, "robot/*/move")
    publisher = client.publisher("robot/a/move", Delivery.EVERY)
    introduced(publisher, inbox, wake)
    for number in range(1000):
        publisher.put(str(number).encode())
    assert drained(publisher, inbox, wake, b"last")[:-1] == [str(number).encode() for number in range(1000)]
    publisher.put(b"payload", attachment=b"header")
    while not (samples := inbox.poll()):
        wake.wait()
    assert (samples[0].key, samples[0].payload, samples[0].attachment) == (
        "robot/a/move",
        b"payload",
        b"header",
    )


def test_of_a_newest_delivery_the_last_few_are_kept(hub: Session, client: Session) -> None:
    newest = hub.inbox("robot/a/pose", Delivery.NEWEST)
    all_of_them = hub.inbox("robot/*/pose", Delivery.NEWEST, keep_all=True)
    wake = Arrivals(hub, "robot/*/pose")
    publisher = client.publisher("robot/a/pose", Delivery.NEWEST)
    introduced(publisher, all_of_them, wake)
    for number in range(2 * NEWEST_KEPT):
        publisher.put(str(number).encode())
    assert len(drained(publisher, all_of_them, wake, b"last")) == 2 * NEWEST_KEPT + 1
    kept = [sample.payload for sample in newest.poll()]
    assert len(kept) == NEWEST_KEPT
    assert kept[-1] == b"last"


def test_clients_reach_each_other_through_the_hub(hub: Session, client: Session, endpoint: str) -> None:  # noqa: ARG001
    with Session(SessionSettings(endpoint)) as other:
        inbox = other.inbox("run/state", Delivery.EVERY)
        wake = Arrivals(other, "run/state")
        publisher = client.publisher("run/state", Delivery.EVERY)
        introduced(publisher, inbox, wake)
        assert drained(publisher, inbox, wake, b"last") == [b"last"]


def test_arrivals_come_in_order_from_another_session_and_from_our_own(hub: Session, client: Session) -> None:
    """Zenoh's thread calls for the client, the test's own thread for the hub's own sender."""
    arrived: SimpleQueue[bytes] = SimpleQueue()
    hub.on_arrival("robot/*/move", arrived.put)
    hub.publisher("robot/b/move", Delivery.EVERY).put(b"own")
    assert arrived.get_nowait() == b"own"
    publisher = client.publisher("robot/a/move", Delivery.EVERY)
    while arrived.empty():
        publisher.put(b"hello")
    payloads = [str(number).encode() for number in range(1000)]
    for payload in payloads:
        publisher.put(payload)
    received = iter(arrived.get, payloads[-1])
    assert [payload for payload in received if payload != b"hello"] == payloads[:-1]


def test_presence_comes_and_goes_with_the_session(hub: Session, endpoint: str) -> None:
    with Session(SessionSettings(endpoint)) as session:
        session.declare_alive("alive/robot/a/here/1")
        while not hub.alive("alive/robot/**"):
            pass
        assert hub.alive("alive/robot/**") == ["alive/robot/a/here/1"]
    while hub.alive("alive/robot/**"):
        pass


def test_a_busy_port_is_one_clear_line(hub: Session, endpoint: str) -> None:  # noqa: ARG001
    with pytest.raises(UserError) as error, Session(SessionSettings(endpoint, hub=True)):
        pass
    assert str(error.value).startswith(f"cannot listen on {endpoint}: is another server running there")
    assert "\n" not in str(error.value)


def test_no_server_is_one_clear_line(endpoint: str) -> None:
    with (
        pytest.raises(UserError, match=r"is it running\?"),
        Session(SessionSettings(endpoint, wait_for_hub=False)),
    ):
        pass


@pytest.mark.parametrize("content", [None, "{ this is no JSON5"])
def test_a_bad_zenoh_file_is_named(tmp_path: Path, endpoint: str, content: str | None) -> None:
    file = tmp_path / "zenoh.json5"
    if content is not None:
        file.write_text(content)
    with (
        pytest.raises(UserError, match=r"zenoh\.json5: no Zenoh configuration"),
        Session(SessionSettings(endpoint, hub=True, config=file)),
    ):
        pass


def test_a_zenoh_file_may_limit_what_clients_do(tmp_path: Path, endpoint: str) -> None:
    """Access control from a file: a client's puts under one key do not arrive, under another they do."""
    file = tmp_path / "zenoh.json5"
    file.write_text(
        """{access_control: {enabled: true, default_permission: "allow",
            rules: [{id: "no", messages: ["put"], flows: ["ingress"], permission: "deny",
                     key_exprs: ["robot/b/**"]}],
            subjects: [{id: "all"}], policies: [{rules: ["no"], subjects: ["all"]}]}}"""
    )
    with (
        Session(SessionSettings(endpoint, hub=True, config=file)) as hub,
        Session(SessionSettings(endpoint)) as client,
    ):
        inbox = hub.inbox("robot/**", Delivery.EVERY)
        wake = Arrivals(hub, "robot/**")
        allowed = client.publisher("robot/a/move", Delivery.EVERY)
        introduced(allowed, inbox, wake)
        client.publisher("robot/b/move", Delivery.EVERY).put(b"forged")
        assert drained(allowed, inbox, wake, b"last") == [b"last"]


def test_a_message_of_70_mb_is_dropped_and_the_next_one_arrives(hub: Session, client: Session) -> None:
    inbox = hub.inbox("robot/*/move", Delivery.EVERY)
    wake = Arrivals(hub, "robot/*/move")
    publisher = client.publisher("robot/a/move", Delivery.EVERY)
    introduced(publisher, inbox, wake)
    publisher.put(bytes(70 << 20))
    arrived = drained(publisher, inbox, wake, b"last")
    assert [len(payload) for payload in arrived] == [len(b"last")]
    publisher.put(bytes(LARGEST_MESSAGE_BYTES // 2))
    assert LARGEST_MESSAGE_BYTES // 2 in map(len, drained(publisher, inbox, wake, b"end"))
