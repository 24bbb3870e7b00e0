"""What an identity may do, read off the key table: what stands here no rule has to say again.

A robot speaks under its own keys and hears its own pose, its own orders and the run's state: the paper's
rule that nothing but what the camera sees crosses from one robot to another, held by the hub.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

from swarm.access.identities import Identity
from swarm.messages import topics
from swarm.messages.topics import ACCOUNT, ALIVE, ASKED_BY, EARLIER, RECOVERY, TABLE, Role, Topic


class Act(Enum):
    """What can be done with a key."""

    SEND = "send"
    HEAR = "hear"
    ASK = "ask"
    ANSWER = "answer"
    REPEAT = "repeat"
    """Answer for what lies below it with samples of its own: what was said under it, once more."""
    SHOW = "show"
    """Show presence under it."""
    SEE = "see"
    """See who shows presence under it."""


@dataclass(frozen=True)
class Right:
    """An act, and the key expression that it is granted for."""

    act: Act
    key: str


KINDS_OF_ROBOT = ("robot", EARLIER["robot"], "calibration", "imitation")
"""The kinds of presence of what runs on a robot's board: its agent, or a tool in its place."""
EVERYBODY = "alive/**"


def rights_of(identity: Identity, robots: Sequence[str], simulated: bool) -> list[Right]:
    """All that an identity may do; whatever is not in the list is refused.

    `simulated` grants what only simulated or emulated robots need: their true poses, and to be carried. What
    plays the bodies of emulated robots has the tracker's identity.
    """
    known = [topic for topic in TABLE if simulated or not topic.pattern.startswith("sim/")]
    grants = {
        Role.SERVER: _server,
        Role.TRACKER: _tracker,
        Role.ROBOT: _robot,
        Role.OPERATOR: _operator,
        Role.VIEWER: _observer,
    }
    found = dict.fromkeys(grants[identity.role](identity, known, robots))
    asks = (Right(Act.ASK, key) for key, roles in ASKED_BY.items() if identity.role in roles)
    return [*found, *asks]


Known = Iterable[Topic[Any]]


def _server(identity: Identity, known: Known, robots: Sequence[str]) -> Iterator[Right]:
    for topic in known:
        if topic.sender is identity.role:
            yield from _each(Act.SEND, topic, robots)
        else:
            yield from _each(Act.HEAR, topic, robots)
            yield from _recovery((Act.ASK, Act.HEAR, Act.SEE), topic, robots)
            yield from _each(Act.ASK, topic, robots) if topic.is_recovered else ()
    yield Right(Act.HEAR, ACCOUNT.format(name="*"))
    yield from (Right(Act.ANSWER, key) for key in ASKED_BY)
    yield from (Right(Act.SHOW, presence_of("server", "server")), Right(Act.SEE, EVERYBODY))


def _tracker(identity: Identity, known: Known, robots: Sequence[str]) -> Iterator[Right]:
    for topic in known:
        if topic.sender is identity.role or topic is topics.TRUTH:
            yield from _sent(topic, robots)
        if topic in (topics.RUN_STATE, topics.TRUTH, topics.CARRY):
            yield from (Right(Act.HEAR, topic.key()), *_each(Act.HEAR, topic, robots))
    plays_bodies = topics.TRUTH in known
    kinds = {"tracker": "bridge", EARLIER["tracker"]: "bridge"}
    kinds |= {"emulator": "robots"} if plays_bodies else {}
    for kind, name in kinds.items():
        yield Right(Act.SEND, ACCOUNT.format(name=name))
        yield Right(Act.SHOW, presence_of(kind, name))
        yield Right(Act.SEE, presence_of(kind, "*"))
    yield Right(Act.SEE, presence_of("server", "*"))
    if plays_bodies:
        yield Right(Act.SEE, presence_of("robot", "*"))


def _robot(identity: Identity, known: Known, robots: Sequence[str]) -> Iterator[Right]:  # noqa: ARG001
    own = (identity.robot,)
    for topic in known:
        if topic.sender is identity.role:
            yield from _sent(topic, own)
        elif topic.to_robot or topic in (topics.CARRY, topics.VIEW):
            yield from _each(Act.HEAR, topic, own)
    yield Right(Act.SEND, ACCOUNT.format(name=identity.robot))
    for kind in KINDS_OF_ROBOT:
        yield Right(Act.SHOW, presence_of(kind, identity.robot))
        yield Right(Act.SEE, presence_of(kind, identity.robot))
    yield from (Right(Act.SEE, presence_of(kind, "*")) for kind in ("server", "tracker"))


def _operator(identity: Identity, known: Known, robots: Sequence[str]) -> Iterator[Right]:
    for topic in known:
        if topic.sender is identity.role:
            yield from _each(Act.SEND, topic, robots)
    yield from _observer(identity, known, robots)


def _observer(identity: Identity, known: Known, robots: Sequence[str]) -> Iterator[Right]:  # noqa: ARG001
    yield from (Right(Act.HEAR, topic.key()) for topic in known)
    yield Right(Act.SEE, EVERYBODY)


def _sent(topic: Topic[Any], robots: Sequence[str]) -> Iterator[Right]:
    """To send a topic, and to answer a server that missed some of it."""
    yield from _each(Act.SEND, topic, robots)
    yield from _each(Act.REPEAT, topic, robots) if topic.is_recovered else ()
    yield from _recovery((Act.ANSWER, Act.SEND, Act.SHOW), topic, robots)


def _recovery(acts: Iterable[Act], topic: Topic[Any], robots: Sequence[str]) -> Iterator[Right]:
    """What it takes besides to have messages once more; nothing for a topic that needs none."""
    for act in acts if topic.is_recovered else ():
        yield from (Right(act, RECOVERY.format(key=right.key)) for right in _each(act, topic, robots))


def _each(act: Act, topic: Topic[Any], robots: Sequence[str]) -> Iterator[Right]:
    """A topic's key for each robot; one if it names none."""
    yield from (Right(act, topic.key(robot)) for robot in (robots if "{robot}" in topic.pattern else ("",)))


def presence_of(kind: str, name: str) -> str:
    """The presence keys of a kind and a name, on any host."""
    return ALIVE.format(kind=kind, name=name, host="*", epoch="*", identity="*")
