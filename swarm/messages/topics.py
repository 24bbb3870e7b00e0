"""One table of everything on the wire: readers, recorder, health and the documentation use it.

A robot's name stands in its keys and nowhere else, so a message cannot claim another sender. A robot
receives its own pose, its own orders, the run's state and an emergency stop (`to_robot`): the paper's rule
that nothing but what the camera sees crosses from one robot to another can be read off this table.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Any, Generic, TypeVar

from google.protobuf.message import Message

from swarm.messages import swarm_pb2 as pb

M = TypeVar("M", bound=Message)

ID_PATTERN = re.compile(r"[a-z][a-z0-9_-]{0,31}")


class Delivery(Enum):
    """What may be lost when the link is slow."""

    EVERY = "every"
    """Reliable, the sender waits: learning events and orders."""
    NEWEST = "newest"
    """Reliable while there is room, only the newest counts: poses, commands, states."""
    BULK = "bulk"
    """Dropped first: images."""
    URGENT = "urgent"
    """Ahead of everything, said again and again, nobody waits for one who does not listen: emergencies."""


class Role(Enum):
    """Who takes part in a laboratory; a certificate is of one of them."""

    SERVER = "server"
    TRACKER = "tracker"
    ROBOT = "robot"
    OPERATOR = "operator"
    VIEWER = "viewer"
    """Hears everything and says nothing."""


SHORT_BYTES = 1_024
"""Room for a message of numbers: the longest of them takes some 120 bytes, its header 24."""
MIDDLE_BYTES = 8_192
"""With words, or lists of numbers: a page of text, a path of thousands of moves."""
LONG_BYTES = 65_536 + 24
"""With lists of messages: no payload that is larger is decoded. Its header comes beside it."""


ROOM_BYTES = 8 << 20
"""Under one key: 8,000 short messages, or 127 of the longest."""
KEPT = 900
"""Half an hour of a robot's moves, which stands while no server is there; what a hub takes in at once."""


@dataclass(frozen=True, eq=False)
class Topic(Generic[M]):
    """One line of the key table: itself and no other. `{robot}` in the pattern stands for a robot's id."""

    pattern: str
    message: type[M]
    meaning: str
    rate_hz: float | None
    delivery: Delivery
    logged: bool
    to_robot: bool = False
    sender: Role = Role.ROBOT
    """Who publishes it, and nobody else; a robot only under its own id."""

    def __post_init__(self) -> None:
        if self.sender is Role.ROBOT and "{robot}" not in self.pattern:
            raise ValueError(f"{self.pattern}: a robot speaks under its own id; who else sends this?")

    @property
    def largest_bytes(self) -> int:
        """Of payload and header together; a hub drops what is larger."""
        fields = self.message.DESCRIPTOR.fields
        if any(field.is_repeated and field.message_type for field in fields):
            return LONG_BYTES
        if any(field.is_repeated or field.type == field.TYPE_STRING for field in fields):
            return MIDDLE_BYTES
        return SHORT_BYTES

    @property
    def most_waiting(self) -> int:
        """How many messages under one of its keys wait at most until a server looks."""
        return ROOM_BYTES // self.largest_bytes

    @property
    def kept(self) -> int:
        """How many messages under one of its keys a sender keeps for a server that missed them."""
        return min(KEPT, self.most_waiting * 9 // 10)

    @property
    def is_recovered(self) -> bool:
        """Whether a server asks for what it missed of it."""
        return self.delivery is Delivery.EVERY and self.sender in (Role.ROBOT, Role.TRACKER)

    def key(self, robot: str = "*") -> str:
        """The key of one robot, or with "*" the expression for all of them."""
        return self.pattern.format(robot=robot)


POSE = Topic(
    "robot/{robot}/pose",
    pb.Pose,
    "its place, from the tracker",
    10.0,
    Delivery.NEWEST,
    True,
    to_robot=True,
    sender=Role.TRACKER,
)
ORDER = Topic(
    "robot/{robot}/order",
    pb.Order,
    "what the conductor wants",
    None,
    Delivery.EVERY,
    True,
    to_robot=True,
    sender=Role.SERVER,
)
RUN_STATE = Topic(
    "run/state", pb.RunState, "phase and trial", 1.0, Delivery.NEWEST, True, to_robot=True, sender=Role.SERVER
)
ESTOP = Topic(
    "operator/estop",
    pb.EmergencyStop,
    "all wheels stop at once",
    None,
    Delivery.URGENT,
    False,
    to_robot=True,
    sender=Role.OPERATOR,
)
COMMAND = Topic(
    "robot/{robot}/command", pb.Command, "wheel speeds as sent, pose believed", 10.0, Delivery.NEWEST, True
)
MOVE = Topic("robot/{robot}/move", pb.Move, "one transition learnt", None, Delivery.EVERY, True)
BEST_PATH = Topic("robot/{robot}/best_path", pb.BestPath, "every ten moves", None, Delivery.EVERY, True)
PATH = Topic("robot/{robot}/path", pb.PathRemembered, "a path entered the memory", None, Delivery.EVERY, True)
REPLAY = Topic("robot/{robot}/replay", pb.Replay, "a replay ended", None, Delivery.EVERY, True)
BEST_MOVES = Topic(
    "robot/{robot}/best_moves",
    pb.BestMoves,
    "its internal state, if another may access it",
    None,
    Delivery.EVERY,
    True,
)
STATUS = Topic("robot/{robot}/status", pb.Status, "activity and health", 1.0, Delivery.NEWEST, True)
EVENT = Topic("robot/{robot}/event", pb.Event, "what a person should know", None, Delivery.EVERY, True)
TRACKER_EVENT = Topic(
    "tracker/event", pb.Event, "rejected poses, lost robots", None, Delivery.EVERY, True, sender=Role.TRACKER
)
SERVER_EVENT = Topic(
    "server/event", pb.Event, "what the conductor did", None, Delivery.EVERY, True, sender=Role.SERVER
)
VISIT = Topic("robot/{robot}/visit", pb.Visit, "watching another robot", None, Delivery.EVERY, True)
OBSERVATION = Topic(
    "robot/{robot}/observation", pb.Observation, "how frames became moves", None, Delivery.EVERY, True
)
COPY_ERROR = Topic(
    "server/{robot}/copy_error",
    pb.CopyError,
    "copied against real moves",
    None,
    Delivery.EVERY,
    True,
    sender=Role.SERVER,
)
TRUTH = Topic("sim/{robot}/truth", pb.Truth, "simulation: where it really is", 10.0, Delivery.NEWEST, True)
CARRY = Topic(
    "sim/{robot}/carry", pb.Carry, "simulation: moved by hand", None, Delivery.EVERY, True, sender=Role.SERVER
)
VIEW = Topic(
    "sim/{robot}/view",
    pb.View,
    "simulation: what its camera faces",
    None,
    Delivery.NEWEST,
    False,
    sender=Role.SERVER,
)

TABLE: tuple[Topic[Any], ...] = (
    POSE,
    ORDER,
    RUN_STATE,
    ESTOP,
    COMMAND,
    MOVE,
    BEST_PATH,
    PATH,
    REPLAY,
    BEST_MOVES,
    STATUS,
    EVENT,
    VISIT,
    OBSERVATION,
    COPY_ERROR,
    TRACKER_EVENT,
    SERVER_EVENT,
    TRUTH,
    CARRY,
    VIEW,
)

LOCKSTEP_TICK = "lockstep/tick/{process}"
LOCKSTEP_DONE = "lockstep/done"
RECOVERY = "{key}/@adv/**"
"""What a sender and a server say to each other about messages that were missed: Zenoh's own keys."""
ACCOUNT = "account/{name}"
"""What a process says as it leaves: how many messages of each key it has sent."""
ALIVE = "alive/{kind}/{name}/{host}/{epoch}/{identity}"
"""Presence (liveliness tokens): kind is robot, tracker, server or process; identity is a fingerprint."""
EARLIER = {"robot": "earlier-robot", "tracker": "earlier-tracker"}
"""Kinds of presence of a robot's or tracker's starts that are over: a later one repeats what they said."""
NO_ROBOT = {topic.pattern.split("/")[0] for topic in TABLE if "{robot}" not in topic.pattern} | {"view"}
"""What the tables of a log call those who are no robot: no robot may be called so. `view` is the server's."""
VIEW_ARENA, VIEW_ROBOTS, VIEW_LOG = "view/arena", "view/robots", "view/log"
"""Never on the wire: what the server writes into the log for viewers, in Foxglove's schemas."""
RUN_IDENTITY = "run/identity"
"""Asked, not published: the server answers with the run's id and every setting."""
RUN_STATUS = "run/status"
"""Asked: the server answers with a `RunStatus`."""
OPERATOR_ORDER = "operator/order"
"""Asked with an `OperatorOrder`: the server obeys or refuses, and answers with an `OrderAnswer`."""
ASKED_BY: Mapping[str, tuple[Role, ...]] = {
    RUN_IDENTITY: (Role.ROBOT, Role.TRACKER, Role.OPERATOR, Role.VIEWER),
    RUN_STATUS: (Role.OPERATOR, Role.VIEWER),
    OPERATOR_ORDER: (Role.OPERATOR,),
}
"""Who may ask the server for what."""


def is_id(name: str) -> bool:
    """Whether a name may be a robot's, process's or run's id."""
    return ID_PATTERN.fullmatch(name) is not None


@lru_cache(maxsize=65_536)
def topic_of(key: str) -> tuple[Topic[Any], str] | None:
    """The line of the table that a key belongs to and the robot it names ("" for none)."""
    for topic in TABLE:
        before, _, after = topic.pattern.partition("{robot}")
        if topic.pattern == key:
            return topic, ""
        robot = key[len(before) : len(key) - len(after)]
        if "{robot}" in topic.pattern and before + robot + after == key and is_id(robot):
            return topic, robot
    return None
