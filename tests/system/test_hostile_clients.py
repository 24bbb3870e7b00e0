"""What a hostile client can do at a hub with certificates: nothing that the rules do not grant.

Every client tries every act of Zenoh's with every key of the key table, with expressions that would hold
several, and with keys beside the table: a key that is added to the table is tried by itself. What is expected
is written here a second time, from the side of the paper's rule, and not taken from the rules.
"""

from __future__ import annotations

import itertools
import json
import shutil
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event
from typing import Any

import pytest
import zenoh

from swarm.access.identities import TRACKER, VIEWER
from swarm.access.zenoh_limits import hub_limits
from swarm.errors import UserError
from swarm.messages import topics
from swarm.messages.topics import ACCOUNT, ASKED_BY, LOCKSTEP_DONE, TABLE, Delivery, Role, topic_of
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.certified import CertifiedLaboratory
from tests.support.endpoints import free_endpoint

ROBOTS = ("r0", "r1")
CLIENTS = ("revoked", "robot-r1", "viewer", "tracker", "operator")
BESIDE = ("robot/**", "**", "*/r0/*", "robot/r0/nothing", "other/key", LOCKSTEP_DONE, "@/**")
"""Expressions that hold more than one key may say, and keys that nobody has."""
PUBLISHED = [topic.key(robot) for topic in TABLE for robot in ROBOTS] + [
    ACCOUNT.format(name=name) for name in (*ROBOTS, "bridge")
]
KEYS = [*dict.fromkeys((*PUBLISHED, *ASKED_BY, *BESIDE))]
TOKENS = [
    topics.ALIVE.format(kind=kind, name=name, host="h", epoch="7", identity="x")
    for kind, name in itertools.product(
        ("robot", "tracker", "server", "emulator", "calibration", "operator"),
        (*ROBOTS, "bridge", "server", "robots"),
    )
]
LOOKS = [*(token.replace("h/7/x", "*/*/*") for token in TOKENS), "alive/**"]
ANSWER_WITHIN_S = 1.0
"""An answer that is let through comes in some milliseconds."""
SETTLE_S = 0.3
"""What has not come by then, on one machine, was not let through: what is let through comes in 5 ms."""


def may_send(client: str, key: str) -> bool:
    """A robot speaks for itself; the tracker tells poses, and plays bodies in simulations."""
    found = topic_of(key)
    if client == "robot-r1":
        return key == "account/r1" or bool(found and found[0].sender is Role.ROBOT and found[1] == "r1")
    if client == str(TRACKER):
        own = key == "account/bridge" or (found is not None and found[0].sender is Role.TRACKER)
        return own or (found is not None and found[0] is topics.TRUTH)
    return bool(client == "operator" and found and found[0].sender is Role.OPERATOR)


def may_hear(client: str, key: str) -> bool:
    """A robot hears what is meant for it; who watches hears all that is in the table."""
    found = topic_of(key)
    if found is None:
        return False
    topic, robot = found
    if client == "robot-r1":
        to_it = topic.to_robot or topic in (topics.CARRY, topics.VIEW)
        return to_it and robot in ("", "r1")
    if client == str(TRACKER):
        return topic in (topics.RUN_STATE, topics.TRUTH, topics.CARRY)
    return client in ("operator", str(VIEWER))


def may_ask(client: str, key: str) -> bool:
    return client != "revoked" and Role(client.partition("-")[0]) in ASKED_BY.get(key, ())


def may_show(client: str, token: str) -> bool:
    _, kind, name, *_ = token.split("/")
    if client == "robot-r1":
        return kind in ("robot", "calibration", "imitation") and name == "r1"
    return client == str(TRACKER) and (kind, name) in (("tracker", "bridge"), ("emulator", "robots"))


def may_see(client: str, token: str) -> bool:
    kind = token.split("/")[1]
    if client == "robot-r1":
        return kind in ("server", "tracker") or may_show(client, token)
    if client == str(TRACKER):
        return kind in ("server", "tracker", "robot", "emulator")
    return client in ("operator", str(VIEWER))


TRUE, FORGED = b"true", b"forged"


@dataclass
class Got:
    """What came through: to the others from a client that tried everything, and to that client."""

    sent: set[str] = field(default_factory=set)
    deleted: set[str] = field(default_factory=set)
    answered: set[str] = field(default_factory=set)
    shown: set[str] = field(default_factory=set)
    heard: set[str] = field(default_factory=set)
    told: set[str] = field(default_factory=set)
    seen: set[str] = field(default_factory=set)


class Attempt:
    """A client's two sessions: what one of them does, the other listens for, and the hub."""

    def __init__(
        self, laboratory: CertifiedLaboratory, hub: Session, identity: str, stack: ExitStack
    ) -> None:
        self._hub = hub
        self._hears_all = hub.inbox("**", Delivery.EVERY)
        self._acting = stack.enter_context(laboratory.client(identity))
        self._listening = stack.enter_context(laboratory.client(identity))
        self._kept: list[Any] = []
        self._deleted: set[str] = set()

    def made(self, expected: Got) -> Got:
        """Try everything, and tell what came through: what is expected, however long it takes, and what has
        come a while later.
        """
        room = zenoh.handlers.FifoChannel
        listening, seeing = self._listening, self._listening.liveliness()
        subscribers = [listening.declare_subscriber(key, room(1000)) for key in KEYS]
        watches = [seeing.declare_subscriber(key, room(1000), history=True) for key in LOOKS]
        for key in KEYS:
            self._kept.append(self._acting.declare_queryable(key, _answer_forged))
        self._kept += [self._acting.liveliness().declare_token(token) for token in TOKENS]
        got = Got()
        _settle(got.shown, expected.shown, lambda: set(self._hub.alive("alive/**")))
        self._hub_says_everything()
        questions = [listening.get(key, timeout=ANSWER_WITHIN_S) for key in KEYS]
        looks = [seeing.get(key, timeout=ANSWER_WITHIN_S) for key in LOOKS]
        for key in KEYS:
            self._acting.put(key, FORGED, attachment=FORGED)
        for key in KEYS:
            self._acting.delete(key)
        _settle(got.sent, expected.sent, lambda: self._came_with(FORGED))
        got.deleted |= self._deleted
        got.answered |= {key for key in KEYS if FORGED in self._hub.ask(key, ANSWER_WITHIN_S)}
        _settle(
            got.heard, expected.heard, lambda: {key for key, what in _samples(subscribers) if what == TRUE}
        )
        _settle(got.seen, expected.seen, lambda: {key for key, _ in _samples(watches)} - got.shown)
        got.told |= {key for key, payload in _replies(questions) if payload != FORGED}
        got.seen |= {key for key, _ in _replies(looks)} - got.shown
        return got

    def is_own(self, key: str) -> bool:
        """Whether a key is of the client's own sessions, which tell about themselves."""
        return any(str(session.zid()) in key for session in (self._acting, self._listening))

    def _came_with(self, wanted: bytes) -> set[str]:
        """Keys of what has come at the hub with a payload; one without is a delete."""
        samples = self._hears_all.poll()
        self._deleted |= {sample.key for sample in samples if not sample.payload}
        return {sample.key for sample in samples if sample.payload == wanted}

    def _hub_says_everything(self) -> None:
        for key in [key for key in KEYS if "*" not in key and not key.startswith("@")]:
            self._hub.answer(key, TRUE)
            self._hub.publisher(key, Delivery.EVERY).put(TRUE)
        for token in TOKENS:
            self._hub.declare_alive(token.replace("/7/", "/8/"))


def _settle(got: set[str], expected: set[str], more: Callable[[], set[str]]) -> None:
    """Take in more until what is expected has come, and what comes soon after."""
    while not expected <= got:
        got |= more()
    Event().wait(SETTLE_S)
    got |= more()


def _answer_forged(query: zenoh.Query) -> None:
    with query, suppress(zenoh.ZError):
        query.reply(query.key_expr, FORGED)


def _samples(subscribers: list[Any]) -> list[tuple[str, bytes]]:
    found = []
    for subscriber in subscribers:
        while (sample := subscriber.try_recv()) is not None:
            found.append((str(sample.key_expr), bytes(sample.payload)))
    return found


def _true_keys(subscribers: list[Any]) -> set[str]:
    return {key for key, payload in _samples(subscribers) if payload == TRUE}


def _replies(questions: list[Any]) -> list[tuple[str, bytes]]:
    """Who asks for everything under `@` is told of its own session, by itself."""
    oks = [reply.ok for question in questions for reply in question if reply.ok is not None]
    return [(str(ok.key_expr), bytes(ok.payload)) for ok in oks]


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> CertifiedLaboratory:
    return CertifiedLaboratory(tmp_path_factory.mktemp("hostile"), ROBOTS)


@pytest.mark.parametrize("client", CLIENTS)
def test_nothing_gets_through_that_is_not_granted(laboratory: CertifiedLaboratory, client: str) -> None:
    later = {token.replace("/7/", "/8/") for token in TOKENS}
    expected = Got(
        sent={key for key in KEYS if may_send(client, key)},
        shown={token for token in TOKENS if may_show(client, token)},
        heard={key for key in PUBLISHED if may_hear(client, key)},
        told={key for key in KEYS if may_ask(client, key)},
        seen={token for token in later if may_see(client, token)},
    )
    with ExitStack() as stack, laboratory.hub() as hub:
        attempt = Attempt(laboratory, hub, client, stack)
        got = attempt.made(expected)
        got.told = {key for key in got.told if not attempt.is_own(key)}
    assert got == expected


def test_without_a_certificate_of_the_laboratory_nobody_is_spoken_with(
    laboratory: CertifiedLaboratory, tmp_path: Path
) -> None:
    other = CertifiedLaboratory(tmp_path, ROBOTS)
    other.endpoint = laboratory.endpoint
    with laboratory.hub():
        for stranger, identity in ((laboratory, ""), (other, "robot-r0"), (other, "server")):
            with pytest.raises(zenoh.ZError), stranger.client(identity):
                pass


def test_a_robot_that_plays_the_server_is_not_believed(
    laboratory: CertifiedLaboratory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    endpoint = free_endpoint().replace("tcp/", "tls/")
    stolen = tmp_path / "server"
    shutil.copytree(laboratory.keys("robot-r1"), stolen)
    shutil.copy(laboratory.keys("server") / "access.json", stolen)
    played = SessionSettings(endpoint, hub=True, credentials=stolen)
    monkeypatch.setattr(laboratory, "endpoint", endpoint)
    victim = laboratory.settings("robot-r0")
    with Session(played):
        with pytest.raises(zenoh.ZError), laboratory.client("robot-r0"):
            pass
        with pytest.raises(UserError, match="unsuitable certificate purpose"), Session(victim):
            pass


def test_a_router_of_its_own_takes_the_same_rules(
    laboratory: CertifiedLaboratory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a stock zenohd would read; here a session of Zenoh's reads it."""
    monkeypatch.chdir(laboratory.keys("server"))
    config = zenoh.Config.from_file("zenohd.json")
    config.insert_json5("listen/endpoints", json.dumps([laboratory.endpoint]))
    with (
        zenoh.open(config),
        Session(laboratory.settings("server")) as server,
        Session(laboratory.settings("robot-r0")) as robot,
    ):
        orders = robot.inbox("robot/r0/order", Delivery.EVERY)
        moves = server.inbox("robot/r0/move", Delivery.EVERY)
        forged = server.inbox("robot/r1/move", Delivery.EVERY)
        server.answer("run/identity", TRUE)
        say, act = (
            server.publisher("robot/r0/order", Delivery.EVERY),
            robot.publisher("robot/r0/move", Delivery.EVERY),
        )
        lie = robot.publisher("robot/r1/move", Delivery.EVERY)
        heard: list[bytes] = []
        told: list[bytes] = []
        while not (heard and told):
            say.put(b"order")
            lie.put(FORGED)
            act.put(b"move")
            heard += [sample.payload for sample in orders.poll()]
            told += [sample.payload for sample in moves.poll()]
        assert robot.ask("run/identity", 5.0) == [TRUE]
        assert forged.poll() == []


def test_without_certificates_too_nobody_else_is_the_server() -> None:
    """Everything is open there, but what the server says comes from the server's own session."""
    endpoint = free_endpoint()
    servers = {topic.key(robot) for topic in TABLE if topic.sender is Role.SERVER for robot in ROBOTS}
    token = topics.ALIVE.format(kind="server", name="server", host="h", epoch="7", identity="x")
    with (
        Session(SessionSettings(endpoint, hub=True, limits=hub_limits(ROBOTS))) as hub,
        Session(SessionSettings(endpoint)) as client,
        Session(SessionSettings(endpoint)) as victim,
    ):
        heard, hub_heard = victim.inbox("**", Delivery.EVERY), hub.inbox("**", Delivery.EVERY)
        client.declare_alive(token)
        for key in ASKED_BY:
            client.answer(key, FORGED)
        own = client.publisher("robot/r0/move", Delivery.EVERY)
        came: set[str] = set()
        while "robot/r0/move" not in came:
            for key in (*servers, "**", "robot/**", "*/r0/*"):
                client.publisher(key, Delivery.EVERY).put(FORGED)
            own.put(TRUE)
            came |= {sample.key for inbox in (heard, hub_heard) for sample in inbox.poll()}
        Event().wait(SETTLE_S)
        came |= {sample.key for inbox in (heard, hub_heard) for sample in inbox.poll()}
        assert {key for key in came if "*" not in key} == {"robot/r0/move"}, (
            "of expressions nobody takes heed"
        )
        assert victim.alive("alive/**") == []
        assert [victim.ask(key, SETTLE_S) for key in ASKED_BY] == [[] for _ in ASKED_BY]
