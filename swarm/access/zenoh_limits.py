"""What a hub takes in at most, and from whom, as Zenoh's own settings by their place in its configuration.

These hold with and without certificates.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from swarm.access.zenoh_rules import nobody_else_is_the_server
from swarm.messages.topics import CARRY, LONG_BYTES, MIDDLE_BYTES, SHORT_BYTES, TABLE, Delivery, Topic

FASTER = 50.0
"""Times the declared rate: cameras of tracking systems take up to 360 pictures a second, and messages come
close together after a gap in the radio."""
ACCEPT_MS = 2_000
"""Who has connected and says nothing keeps nobody out for longer. A handshake takes some tenths of a
second on a board (10 s is Zenoh's default, with room for 100 who wait)."""
LARGEST_MESSAGE_BYTES = 2 << 20
"""What a hub puts together before anybody can refuse it: twice the answer of what a run's settings are."""


def limits(robots: Sequence[str]) -> dict[str, Any]:
    """How large messages may be, and how many.

    A rate is limited only where the newest counts: of what must not be lost Zenoh would drop the second of
    two that come together.
    """
    return {
        "transport/link/rx/max_message_size": LARGEST_MESSAGE_BYTES,
        "transport/unicast/accept_timeout": ACCEPT_MS,
        "adminspace/enabled": False,
        "low_pass_filter": [
            _at_most("any", ["**"], LONG_BYTES),
            *(
                _at_most(
                    f"{size} bytes", [topic.key() for topic in TABLE if topic.largest_bytes == size], size
                )
                for size in (SHORT_BYTES, MIDDLE_BYTES)
            ),
        ],
        "downsampling": [
            {
                "id": "rates",
                "flows": ["ingress"],
                "messages": ["put"],
                "rules": [
                    {"key_expr": topic.key(robot), "freq": FASTER * topic.rate_hz}
                    for topic in TABLE
                    if topic.rate_hz
                    for robot in (robots if "{robot}" in topic.pattern else ("",))
                ],
            }
        ],
    }


def hub_limits(robots: Sequence[str]) -> dict[str, Any]:
    """Of the hub in the server; the access rules are for one without certificates, and make way for theirs.

    It hears everything itself, so those who only watch may miss something: otherwise one of them that reads
    too slowly holds up the robots, whose moves wait for room.
    """
    watched = [topic.key() for topic in TABLE if topic.delivery is Delivery.EVERY and _is_watched(topic)]
    overwrite = {"congestion_control": "drop"}
    return {
        **limits(robots),
        "qos/network": [
            {"messages": ["put"], "flows": ["egress"], "key_exprs": watched, "overwrite": overwrite}
        ],
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 0,
        "access_control": nobody_else_is_the_server(),
    }


def _is_watched(topic: Topic[Any]) -> bool:
    """Whether none but the server needs a topic."""
    return not topic.to_robot and topic is not CARRY


def _at_most(name: str, keys: list[str], size: int) -> dict[str, Any]:
    return {
        "id": name,
        "flows": ["ingress"],
        "messages": ["put", "delete", "query"],
        "key_exprs": keys,
        "size_limit": size,
    }
