"""The key table as documentation: `python -m swarm.messages.topic_reference > docs/keys.md`."""

from __future__ import annotations

from typing import Any

from swarm.messages.topics import (
    ACCOUNT,
    ALIVE,
    LOCKSTEP_DONE,
    LOCKSTEP_TICK,
    OPERATOR_ORDER,
    RUN_IDENTITY,
    RUN_STATUS,
    TABLE,
    VIEW_ARENA,
    VIEW_LOG,
    VIEW_ROBOTS,
    Delivery,
    Topic,
)

_HEAD = """# Everything on the wire

One line of `swarm/messages/topics.py` says everything about a message. `{robot}` stands for a robot's id.
Payloads are protobuf messages of `swarm/messages/swarm.proto`; 24 bytes beside each carry the sender's epoch,
the message's number and the run's time (`swarm/messages/header.py`). A robot receives only what the column
*to robots* marks: its own pose, its own orders, the run's state and an emergency stop. Only who stands under
*from* is believed, a robot only under its own id; [certificates](security.md) make that sure.

| key | message | from | meaning | rate | delivery | logged | to robots |
|---|---|---|---|---|---|---|---|
"""

_MEANING = {
    Delivery.EVERY: "reliable, the sender waits: learning events and orders",
    Delivery.NEWEST: "reliable while there is room, only the newest counts: poses, commands, states",
    Delivery.BULK: "dropped first: images",
    Delivery.URGENT: "ahead of everything, said again and again; nobody waits for one who does not listen",
}


def markdown_table() -> str:
    """The page docs/keys.md."""
    rows = "".join(f"| {' | '.join(_cells(topic))} |\n" for topic in TABLE)
    deliveries = "".join(f"- **{delivery.value}**: {meaning}.\n" for delivery, meaning in _MEANING.items())
    return f"{_HEAD}{rows}\nDelivery:\n\n{deliveries}\n{_beside_the_table()}\n{_in_the_log_alone()}"


def _cells(topic: Topic[Any]) -> tuple[str, ...]:
    rate = f"{topic.rate_hz:g} Hz" if topic.rate_hz else "as it happens"
    return (
        f"`{topic.pattern}`",
        f"`{topic.message.DESCRIPTOR.name}`",
        topic.sender.value,
        topic.meaning,
        rate,
        topic.delivery.value,
        _mark(topic.logged),
        _mark(topic.to_robot),
    )


def _mark(yes: bool) -> str:
    return "yes" if yes else ""


def _beside_the_table() -> str:
    return (
        f"Beside the table: `{ALIVE}` are presence tokens (kind is robot, tracker or server),\n"
        f"`{ACCOUNT}` is the closing account of a process that leaves: how many messages of each key it\n"
        f"has sent. Lockstep simulation uses `{LOCKSTEP_TICK}` and `{LOCKSTEP_DONE}`. The server answers a\n"
        f"query for `{RUN_IDENTITY}` with the run's id and all settings, one for `{RUN_STATUS}` with a\n"
        f"`RunStatus`, and one for `{OPERATOR_ORDER}`, whose payload is an `OperatorOrder`, with an\n"
        "`OrderAnswer`. None of these is logged; of every order the log has an event.\n"
    )


def _in_the_log_alone() -> str:
    return (
        "A log holds three more, which are not on the wire: the server makes them for viewers.\n\n"
        "| key | message | meaning | rate |\n|---|---|---|---|\n"
        f"| `{VIEW_ARENA}` | `foxglove.SceneUpdate` | the borders of the compartments | once |\n"
        f"| `{VIEW_ROBOTS}` | `foxglove.PosesInFrame` | the newest pose of every robot | 1 Hz |\n"
        f"| `{VIEW_LOG}` | `foxglove.Log` | every event | as it happens |\n"
    )


if __name__ == "__main__":
    print(markdown_table(), end="")
