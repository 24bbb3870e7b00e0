"""A robot with a certificate goes mad: the others go on, the server keeps its memory and names it."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from itertools import count, pairwise
from pathlib import Path

import pytest
import zenoh
from mcap.reader import make_reader

from swarm.config.experiment import Experiment
from swarm.logs.check import check_log
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence
from tests.support.certified import CertifiedLaboratory
from tests.support.laboratory import Laboratory
from tests.support.waiting import until

pytestmark = pytest.mark.faults

COMMANDS = 60
"""Of the honest robot, during each attack: six seconds at 10 Hz."""
STANDS_AFTER = 10
"""Messages in a row: a robot stands when it has heard nothing for a second."""
LARGEST_GROWTH_BYTES = 128 << 20
"""8 MiB may wait under each of the mad robot's keys, and as much again is being taken in."""
MAD_EPOCH = 77
AT_ONCE = 200


class Madness:
    """The mad robot: each attack sends a piece whenever it is called."""

    def __init__(self, session: zenoh.Session, presence: Presence) -> None:
        self._session = session
        self._presence = presence
        self._numbers = count(1)
        self._tokens = [session.liveliness().declare_token(presence.key)]
        self.attacks: dict[str, Callable[[], None]] = {
            "floods": lambda: self._say("event", 64),
            "floods of words": lambda: self._say("event", 8000),
            "floods of observations": lambda: self._say("observation", 60_000),
            "floods of commands": lambda: self._say("command", 24),
            "new epochs": lambda: self._say("move", 24, epoch=time.time_ns()),
            "no headers": lambda: self._put("robot/r0/move", bytes(24), b"none"),
            "100 MB": lambda: self._put("robot/r0/event", bytes(100 << 20)),
            "new keys": lambda: self._put(f"robot/r0/key{next(self._numbers)}", b"x"),
            "presences": self._show,
        }

    def _say(self, kind: str, size: int, epoch: int = MAD_EPOCH) -> None:
        for _ in range(AT_ONCE):
            header = Header(epoch, next(self._numbers), 0)
            self._put(f"robot/r0/{kind}", bytes(size), header.pack())

    def _put(self, key: str, payload: bytes, attachment: bytes = b"") -> None:
        block = zenoh.CongestionControl.BLOCK
        self._session.put(key, payload, attachment=attachment, congestion_control=block)

    def _show(self) -> None:
        key = self._presence.key.replace(f"/{MAD_EPOCH}/", f"/{1000 + next(self._numbers)}/")
        self._tokens.append(self._session.liveliness().declare_token(key))


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_a_mad_robot_costs_nobody_else_anything(tmp_path: Path, stack: ExitStack) -> None:
    certified = CertifiedLaboratory(tmp_path)
    laboratory = Laboratory(tmp_path, stack, count=2)
    laboratory.endpoint = certified.endpoint
    server = laboratory.serve("--credentials", certified.keys("server"))
    laboratory.track("--credentials", certified.keys("tracker"))
    laboratory.agent("r1", "--credentials", certified.keys("robot-r1"))
    watching = stack.enter_context(_connected(certified, "viewer"))
    stuck = stack.enter_context(certified.client("viewer"))
    unread = stuck.declare_subscriber("robot/*/move", zenoh.handlers.FifoChannel(1))
    stack.callback(unread.undeclare)
    heard = watching.declare_subscriber("robot/r1/command", zenoh.handlers.FifoChannel(10_000))
    identity = RunIdentity.of(Experiment.load(laboratory.file), 0)
    presence = Presence("robot", "r0", "mad", MAD_EPOCH, str(identity.fingerprint))
    madness = Madness(stack.enter_context(certified.client("robot-r0")), presence)
    heard.recv()
    before = _resident_bytes(server.pid)
    for name, attack in madness.attacks.items():
        gap = _longest_gap_during(attack, heard)
        assert gap < STANDS_AFTER / 2, f"{name}: {gap} commands in a row were not heard"
        grown = _resident_bytes(server.pid) - before
        assert grown < LARGEST_GROWTH_BYTES, f"{name}: {grown >> 20} MiB"
    server.terminate()
    server.communicate()
    assert unread.try_recv() is not None
    log = tmp_path / "run" / "trial-000.mcap"
    assert {"flood", "refused", "duplicate"} <= _told(log)
    assert check_log(log).faults, "the mad robot's messages are not what their keys promise"


def _resident_bytes(pid: int) -> int:
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def _told(log: Path) -> set[str]:
    """The names of the events that the server tells of."""
    with log.open("rb") as file:
        found = make_reader(file).iter_messages(topics=["server/event"])
        return {pb.Event.FromString(message.data).name for _, _, message in found}


def _connected(certified: CertifiedLaboratory, identity: str) -> zenoh.Session:
    """Once the server is there."""
    opened: list[zenoh.Session] = []

    def connects() -> bool:
        with suppress(zenoh.ZError):
            opened.append(certified.client(identity))
        return bool(opened)

    until(connects)
    return opened[0]


def _longest_gap_during(
    attack: Callable[[], None], heard: zenoh.Subscriber[zenoh.Handler[zenoh.Sample]]
) -> int:
    """How many of the honest robot's messages in a row are not heard while somebody attacks.

    By its own numbers and not by a clock: the attacker takes a core of the machine that all of them run on.
    """
    while heard.try_recv() is not None:
        pass
    numbers: list[int] = []
    while len(numbers) < COMMANDS:
        attack()
        while (sample := heard.try_recv()) is not None:
            header = Header.unpack(bytes(sample.attachment or b""))
            assert header is not None
            numbers.append(header.sequence)
    return max(later - earlier - 1 for earlier, later in pairwise(numbers))
