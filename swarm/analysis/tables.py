"""Messages to tables: a row for each message, a column for each field, typed by the message's schema.

Every row begins with where it comes from: `log`, `seed`, `trial`, `condition`, `robot`, `epoch`,
`sequence`, and the times of publishing and of receipt in ns of the run's time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import polars as pl
from google.protobuf.message import Message

from swarm import keys
from swarm.analysis.columns import column
from swarm.analysis.log_identity import LogIdentity
from swarm.analysis.log_parts import LogChannel, Part
from swarm.keys import Topic
from swarm.messages.checks import BadMessageError, decode

LEARNING: dict[Topic[Any], str] = {
    keys.MOVE: "moves",
    keys.BEST_PATH: "best_paths",
    keys.PATH: "paths",
    keys.REPLAY: "replays",
    keys.EVENT: "events",
    keys.TRACKER_EVENT: "events",
    keys.SERVER_EVENT: "events",
    keys.ORDER: "orders",
    keys.RUN_STATE: "run_states",
    keys.STATUS: "statuses",
    keys.CARRY: "carries",
    keys.VISIT: "visits",
    keys.OBSERVATION: "observations",
    keys.COPY_ERROR: "copy_errors",
}
"""What is said about learning and about the run: small, always read."""
SAMPLED: dict[Topic[Any], str] = {keys.POSE: "poses", keys.COMMAND: "commands", keys.TRUTH: "truths"}
"""What is sampled many times a second: nearly all of a log."""
TABLE_OF = LEARNING | SAMPLED


@dataclass(frozen=True)
class Rejected:
    """A message that is not what its key promises."""

    key: str
    sequence: int
    reason: str


@dataclass(frozen=True)
class Rows:
    """A part of a table, and what could not enter it."""

    table: str
    frame: pl.DataFrame
    rejected: list[Rejected]


def is_learning(channel: LogChannel) -> bool:
    """Whether a channel's messages enter one of the small tables."""
    return channel.topic in LEARNING


def is_tabled(channel: LogChannel) -> bool:
    """Whether a channel's messages enter any table."""
    return channel.topic in TABLE_OF


def rows(part: Part, identity: LogIdentity) -> Rows:
    """The rows of one part, each message decoded and checked field by field."""
    topic = part.channel.topic
    if topic is None:
        raise ValueError(f"{part.channel.key} enters no table")
    messages, good, rejected = _decoded(part, topic.message)
    columns = _origin(part, identity, good) | _fields(topic.message, messages)
    return Rows(TABLE_OF[topic], pl.DataFrame(columns), rejected)


def empty_table(table: str) -> pl.DataFrame:
    """A table without rows, with the columns that it would have."""
    message = next(topic.message for topic, name in TABLE_OF.items() if name == table)
    texts = dict.fromkeys(("log", "condition", "robot"), pl.String)
    numbers = ("seed", "trial", "epoch", "sequence", "publish_t_ns", "receive_t_ns")
    origin = {name: pl.Series([], dtype=texts.get(name, pl.Int64)) for name in _ORIGIN}
    origin |= {name: pl.Series([], dtype=pl.Int64) for name in numbers}
    return pl.DataFrame({name: origin[name] for name in _ORIGIN} | _fields(message, []))


_ORIGIN = (
    "log",
    "seed",
    "trial",
    "condition",
    "robot",
    "epoch",
    "sequence",
    "publish_t_ns",
    "receive_t_ns",
)


def _decoded(
    part: Part, message_type: type[Message]
) -> tuple[list[Message], slice | list[int], list[Rejected]]:
    """The good messages, their places in the part, and the bad ones."""
    try:
        return [decode(message_type, payload) for payload in part.payloads], slice(None), []
    except BadMessageError:
        return _sorted_out(part, message_type)


def _sorted_out(part: Part, message_type: type[Message]) -> tuple[list[Message], list[int], list[Rejected]]:
    messages, good, rejected = [], [], []
    for place, payload in enumerate(part.payloads):
        try:
            messages.append(decode(message_type, payload))
            good.append(place)
        except BadMessageError as error:
            rejected.append(Rejected(part.channel.key, int(part.sequence[place]), str(error)))
    return messages, good, rejected


def _origin(part: Part, identity: LogIdentity, good: slice | list[int]) -> dict[str, pl.Series]:
    sequence = part.sequence[good]
    sender = part.channel.sender

    def constant(value: str | int) -> pl.Series:
        return pl.repeat(
            value, len(sequence), dtype=pl.String if isinstance(value, str) else pl.Int64, eager=True
        )

    return {
        "log": constant(str(identity.path)),
        "seed": constant(identity.seed),
        "trial": constant(identity.trial),
        "condition": constant(identity.condition(sender)),
        "robot": constant(sender),
        "epoch": constant(part.channel.epoch),
        "sequence": pl.Series(sequence),
        "publish_t_ns": pl.Series(part.publish_t_ns[good]),
        "receive_t_ns": pl.Series(part.receive_t_ns[good]),
    }


def _fields(message_type: type[Message], messages: list[Message]) -> dict[str, pl.Series]:
    return {field.name: column(field, messages) for field in message_type.DESCRIPTOR.fields}
