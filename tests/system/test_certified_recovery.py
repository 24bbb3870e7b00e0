"""With certificates too, a server that comes back gets what it missed from those who may say it."""

from __future__ import annotations

from pathlib import Path

from swarm.messages import topics
from swarm.messages.header import Header
from swarm.runtime.zenoh_session import Inbox, Session
from tests.support.certified import CertifiedLaboratory

MOVE = topics.MOVE.key("r0")
EVENT = topics.TRACKER_EVENT.key()


def wait_for(inbox: Inbox, count: int) -> list[int]:
    """The numbers of so many messages, in the order in which they come."""
    numbers: list[int] = []
    while len(numbers) < count:
        for sample in inbox.poll():
            header = Header.unpack(sample.attachment)
            assert header
            numbers.append(header.sequence)
    return numbers


def test_a_server_that_comes_back_gets_what_it_missed(tmp_path: Path) -> None:
    certified = CertifiedLaboratory(tmp_path)
    hub = certified.hub()
    with (
        Session(certified.settings("robot-r0")) as robot,
        Session(certified.settings("tracker")) as tracker,
    ):
        senders = {
            MOVE: robot.keeping_publisher(MOVE, topics.MOVE.kept),
            EVENT: tracker.keeping_publisher(EVENT, topics.TRACKER_EVENT.kept),
        }

        def say(number: int) -> None:
            for sender in senders.values():
                sender.put(b"", attachment=Header(1, number, 0).pack())

        heard = [hub.recovering_inbox(key, 100) for key in senders]
        for number in (1, 2):
            say(number)
        assert [wait_for(inbox, 2) for inbox in heard] == [[1, 2], [1, 2]]
        hub.close()
        say(3)
        hub = certified.hub()
        heard = [hub.recovering_inbox(key, 100) for key in senders]
        assert [wait_for(inbox, 3) for inbox in heard] == [[1, 2, 3], [1, 2, 3]]
        say(4)
        assert [wait_for(inbox, 1) for inbox in heard] == [[4], [4]]
    hub.close()
