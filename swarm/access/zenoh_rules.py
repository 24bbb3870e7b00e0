"""Rights and the key table as Zenoh's own settings, for the hub in the server and for a router of its own.

What is granted is listed and all else denied. Zenoh judges every message twice: as it comes from a
connection (ingress) and as it goes to one (egress).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from swarm.access.rights import Act, Right, presence_of
from swarm.messages.topics import ASKED_BY, TABLE, Role

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


def nobody_else_is_the_server() -> dict[str, Any]:
    """Zenoh's `access_control` of a hub without certificates: everything, but to speak as the server does.

    The server and the hub are one process there, so that nothing of the server's comes over a connection.
    """
    said = [topic.key() for topic in TABLE if topic.sender is Role.SERVER]
    rules = [
        _denied("say", ("put",), said),
        _denied("delete", ("delete",), ["**"]),
        _denied("answer", ("declare_queryable", "reply"), list(ASKED_BY)),
        _denied("be present", ("liveliness_token",), [presence_of("server", "*")]),
        _denied("administrate", ("put", "query", "declare_subscriber"), ["@/**"]),
    ]
    return {
        "enabled": True,
        "default_permission": "allow",
        "rules": rules,
        "subjects": [{"id": "anybody"}],
        "policies": [{"subjects": ["anybody"], "rules": [rule["id"] for rule in rules]}],
    }


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


def _denied(name: str, messages: Sequence[str], keys: list[str]) -> dict[str, Any]:
    return {
        "id": name,
        "permission": "deny",
        "flows": ["ingress"],
        "messages": list(messages),
        "key_exprs": keys,
    }
