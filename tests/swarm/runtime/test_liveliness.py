"""No two processes under one name."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from swarm.errors import UserError
from swarm.runtime.liveliness import Presence, claim, present
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint


@pytest.fixture
def buses() -> Iterator[tuple[Session, Session]]:
    """Two clients of one hub."""
    endpoint = free_endpoint()
    with (
        Session(SessionSettings(endpoint, hub=True)),
        Session(SessionSettings(endpoint)) as first,
        Session(SessionSettings(endpoint)) as second,
    ):
        yield first, second


def test_a_presence_survives_its_key() -> None:
    presence = Presence("robot", "r1", "lab-pc.local", 17, "fingerprint")
    assert Presence.parse(presence.key) == presence
    assert Presence("robot", "r1", "odd/host name", 1).key == "alive/robot/r1/odd-host-name/1/-"


def test_a_second_robot_of_one_name_is_refused_and_both_hosts_are_named(
    buses: tuple[Session, Session],
) -> None:
    first, second = buses
    claim(first, Presence("robot", "r1", "board-a", 1))
    while not present(second, "robot"):
        pass
    with pytest.raises(UserError) as error:
        claim(second, Presence("robot", "r1", "board-b", 2))
    assert "'r1' is already alive on host 'board-a'; this one on host 'board-b' does not start" in str(
        error.value
    )


def test_other_names_and_kinds_do_not_conflict(buses: tuple[Session, Session]) -> None:
    first, second = buses
    claim(first, Presence("robot", "r1", "board-a", 1))
    claim(second, Presence("robot", "r2", "board-b", 2))
    claim(second, Presence("tracker", "r1", "board-b", 2))
    while len(found := present(first, "robot")) < 2:
        pass
    assert sorted(presence.name for presence in found) == ["r1", "r2"]


def test_a_name_is_free_again_after_its_process_left(buses: tuple[Session, Session]) -> None:
    first, second = buses
    claim(first, Presence("robot", "r1", "board-a", 1))
    first.close()
    while present(second, "robot"):
        pass
    claim(second, Presence("robot", "r1", "board-b", 2))
