"""Rights and the key table as Zenoh's own settings, for the hub in the server and for a router of its own.

What is granted is listed and all else denied. Zenoh judges every message twice: as it comes from a
connection (ingress) and as it goes to one (egress).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from swarm.access.rights import Act, Right
from swarm.messages.topics import CARRY, LONG_BYTES, MIDDLE_BYTES, SHORT_BYTES, TABLE, Delivery, Topic

_MESSAGES: Mapping[Act, Mapping[str, tuple[str, ...]]] = {
    # A publisher sends only what it has been told that somebody hears.
    Act.SEND: {"ingress": ("put",), "egress": ("declare_subscriber",)},
    Act.HEAR: {"ingress": ("declare_subscriber",), "egress": ("put",)},
    Act.ASK: {"ingress": ("query",), "egress": ("reply", "declare_queryable")},
    Act.ANSWER: {"ingress": ("declare_queryable", "reply"), "egress": ("query",)},
    Act.REPEAT: {"ingress": ("reply",)},
    Act.SHOW: {"ingress": ("liveliness_token",)},
    Act.SEE: {
        "ingress": ("liveliness_query", "declare_liveliness_subscriber"),
        "egress": ("liveliness_token",),
    },
}
FASTER = 50.0
"""Times the declared rate: cameras of tracking systems take up to 360 pictures a second, and messages come
close together after a gap in the radio."""
ACCEPT_MS = 2_000
"""Who has connected and says nothing keeps nobody out for longer. A handshake takes some tenths of a
second on a board (10 s is Zenoh's default, with room for 100 who wait)."""
LARGEST_MESSAGE_BYTES = 2 << 20
"""What a hub puts together before anybody can refuse it: twice the answer of what a run's settings are."""


def access_control(granted: Mapping[str, tuple[str, Iterable[Right]]]) -> dict[str, Any]:
    """Zenoh's `access_control`: identity -> the common name of its certificate and its rights."""
    rules = [
        rule
        for name, (_, rights) in granted.items()
        for rule in _rules(name, list(rights))
        if rule["key_exprs"]
    ]
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [
            {"id": name, "cert_common_names": [common_name]} for name, (common_name, _) in granted.items()
        ],
        "policies": [
            {"subjects": [name], "rules": [rule["id"] for rule in rules if rule["id"].startswith(f"{name} ")]}
            for name in granted
        ],
    }


def limits(robots: Sequence[str]) -> dict[str, Any]:
    """Settings of a hub by their place in Zenoh's configuration: how large messages may be, and how many.

    They hold with and without certificates. A rate is limited only where the newest counts: of what must not
    be lost Zenoh would drop the second of two that come together.
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
    """Of the hub in the server, which hears everything itself: those who only watch may miss something.

    Otherwise one of them that reads too slowly holds up the robots, whose moves wait for room.
    """
    watched = [topic.key() for topic in TABLE if topic.delivery is Delivery.EVERY and _is_watched(topic)]
    overwrite = {"congestion_control": "drop"}
    return {
        **limits(robots),
        "qos/network": [
            {"messages": ["put"], "flows": ["egress"], "key_exprs": watched, "overwrite": overwrite}
        ],
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 0,
    }


def _is_watched(topic: Topic[Any]) -> bool:
    """Whether none but the server needs a topic."""
    return not topic.to_robot and topic is not CARRY


def _rules(name: str, rights: Sequence[Right]) -> list[dict[str, Any]]:
    return [
        {
            "id": f"{name} {act.value} {flow}",
            "permission": "allow",
            "flows": [flow],
            "messages": list(messages),
            "key_exprs": [right.key for right in rights if right.act is act],
        }
        for act, flows in _MESSAGES.items()
        for flow, messages in flows.items()
    ]


def _at_most(name: str, keys: list[str], size: int) -> dict[str, Any]:
    return {
        "id": name,
        "flows": ["ingress"],
        "messages": ["put", "delete", "query"],
        "key_exprs": keys,
        "size_limit": size,
    }
