"""What a hostile client can do at a hub with certificates: nothing that the rules do not grant.

Every client tries every act of Zenoh's with every key of the key table, with expressions that would hold
several, and with keys beside the table: a key that is added to the table is tried by itself. What is expected
is written here a second time, from the side of the paper's rule, and not taken from the rules.
"""

from __future__ import annotations

import itertools
import json
import shutil
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event
from typing import Any

import pytest
import zenoh

from swarm.access.identities import TRACKER, VIEWER
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

    def made(self) -> Got:
        """Try everything, and tell what came through."""
        room = zenoh.handlers.FifoChannel
        listening, seeing = self._listening, self._listening.liveliness()
        subscribers = [listening.declare_subscriber(key, room(1000)) for key in KEYS]
        watches = [seeing.declare_subscriber(key, room(1000), history=True) for key in LOOKS]
        for key in KEYS:
            self._kept.append(self._acting.declare_queryable(key, _answer_forged))
        self._kept += [self._acting.liveliness().declare_token(token) for token in TOKENS]
        Event().wait(SETTLE_S)
        got = Got(shown=set(self._hub.alive("alive/**")))
        self._hub_says_everything()
        questions = [listening.get(key, timeout=SETTLE_S) for key in KEYS]
        looks = [seeing.get(key, timeout=SETTLE_S) for key in LOOKS]
        for key in KEYS:
            self._acting.put(key, FORGED, attachment=FORGED)
        for key in KEYS:
            self._acting.delete(key)
        Event().wait(SETTLE_S)
        for sample in self._hears_all.poll():
            if sample.payload != TRUE:
                (got.sent if sample.payload == FORGED else got.deleted).add(sample.key)
        got.answered = {key for key in KEYS if FORGED in self._hub.ask(key, SETTLE_S)}
        got.heard = {key for key, payload in _samples(subscribers) if payload == TRUE}
        got.told = {key for key, payload in _replies(questions) if payload != FORGED}
        got.seen = {key for key, _ in (*_samples(watches), *_replies(looks))} - got.shown
        return got

    def _hub_says_everything(self) -> None:
        for key in [key for key in KEYS if "*" not in key and not key.startswith("@")]:
            self._hub.answer(key, TRUE)
            self._hub.publisher(key, Delivery.EVERY).put(TRUE)
        for token in TOKENS:
            self._hub.declare_alive(token.replace("/7/", "/8/"))


def _answer_forged(query: zenoh.Query) -> None:
    with query, suppress(zenoh.ZError):
        query.reply(query.key_expr, FORGED)


def _samples(subscribers: list[Any]) -> list[tuple[str, bytes]]:
    found = []
    for subscriber in subscribers:
        while (sample := subscriber.try_recv()) is not None:
            found.append((str(sample.key_expr), bytes(sample.payload)))
    return found


def _replies(questions: list[Any]) -> list[tuple[str, bytes]]:
    """Who asks for everything under `@` is told of its own session, by itself."""
    oks = [reply.ok for question in questions for reply in question if reply.ok is not None]
    return [(str(ok.key_expr), bytes(ok.payload)) for ok in oks]


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> CertifiedLaboratory:
    return CertifiedLaboratory(tmp_path_factory.mktemp("hostile"), ROBOTS)


@pytest.mark.parametrize("client", CLIENTS)
def test_nothing_gets_through_that_is_not_granted(laboratory: CertifiedLaboratory, client: str) -> None:
    with ExitStack() as stack, laboratory.hub() as hub:
        attempt = Attempt(laboratory, hub, client, stack)
        got = attempt.made()
        own = {str(attempt._listening.zid()), str(attempt._acting.zid())}
    assert got.sent == {key for key in KEYS if may_send(client, key)}
    assert got.deleted == set()
    assert got.answered == set()
    assert got.shown == {token for token in TOKENS if may_show(client, token)}
    assert got.heard == {key for key in PUBLISHED if may_hear(client, key)}
    told = {key for key in got.told if not any(zid in key for zid in own)}
    assert told == {key for key in KEYS if may_ask(client, key)}
    others = {token.replace("/7/", "/8/") for token in TOKENS}
    assert got.seen == {token for token in others if may_see(client, token)}


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
    laboratory: CertifiedLaboratory, tmp_path: Path
) -> None:
    endpoint = free_endpoint().replace("tcp/", "tls/")
    stolen = tmp_path / "server"
    shutil.copytree(laboratory.keys("robot-r1"), stolen)
    shutil.copy(laboratory.keys("server") / "access.json", stolen)
    played = SessionSettings(endpoint, hub=True, credentials=stolen)
    victim = SessionSettings(endpoint, credentials=laboratory.keys("robot-r0"), wait_for_hub=False)
    with Session(played), pytest.raises(UserError, match="cannot reach the server"), Session(victim):
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
