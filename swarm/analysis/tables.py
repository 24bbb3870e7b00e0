"""Messages to tables: a row for each message, a column for each field, typed by the message's schema.

Every row begins with where it comes from: `log`, `seed`, `trial`, `condition`, `robot`, `epoch`,
`sequence`, and the times of publishing and of receipt in ns of the run's time. A list of messages inside
a message, such as an observation's looks, is a table of its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from typing import Any

import polars as pl
from google.protobuf.message import Message

from swarm import keys
from swarm.analysis.columns import column
from swarm.analysis.log_identity import LogIdentity
from swarm.analysis.log_parts import LogChannel, Part
from swarm.analysis.nested_tables import is_nested, nested_names, nested_table
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
}
"""What is said about learning and about the run: small, always read."""
WATCHING: dict[Topic[Any], str] = {
    keys.VISIT: "visits",
    keys.OBSERVATION: "observations",
    keys.COPY_ERROR: "copy_errors",
}
"""What is said about visits; a run without visits has none of these tables."""
SAMPLED: dict[Topic[Any], str] = {keys.POSE: "poses", keys.COMMAND: "commands", keys.TRUTH: "truths"}
"""What is sampled many times a second: nearly all of a log."""
TABLE_OF = LEARNING | WATCHING | SAMPLED


@dataclass(frozen=True)
class Rejected:
    """A message that is not what its key promises."""

    key: str
    sequence: int
    reason: str


@dataclass(frozen=True)
class Rows:
    """A part of a table."""

    table: str
    frame: pl.DataFrame


@dataclass(frozen=True)
class PartRows:
    """What a part of a log becomes: rows of its table and of the tables nested in it; what was rejected."""

    tables: list[Rows]
    rejected: list[Rejected]


def is_learning(channel: LogChannel) -> bool:
    """Whether a channel's messages enter one of the small tables."""
    return channel.topic in LEARNING or channel.topic in WATCHING


def is_tabled(channel: LogChannel) -> bool:
    """Whether a channel's messages enter any table."""
    return channel.topic in TABLE_OF


def table_names(topics: Iterable[Topic[Any]]) -> tuple[str, ...]:
    """The tables of some topics, each once, with those nested in them."""
    names = ((TABLE_OF[topic], *nested_names(topic.message)) for topic in topics)
    return tuple(dict.fromkeys(chain.from_iterable(names)))


def rows(part: Part, identity: LogIdentity) -> PartRows:
    """The rows of one part, each message decoded and checked field by field."""
    topic = part.channel.topic
    if topic is None:
        raise ValueError(f"{part.channel.key} enters no table")
    messages, good, rejected = _decoded(part, topic.message)
    origin = pl.DataFrame(_origin(part, identity, good))
    return PartRows(_tables(topic, origin, messages), rejected)


def empty_table(table: str) -> pl.DataFrame:
    """A table without rows, with the columns that it would have."""
    topic = next(topic for topic in TABLE_OF if table in table_names([topic]))
    texts = dict.fromkeys(("log", "condition", "robot"), pl.String)
    origin = pl.DataFrame({name: pl.Series([], dtype=texts.get(name, pl.Int64)) for name in _ORIGIN})
    return next(found.frame for found in _tables(topic, origin, []) if found.table == table)


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


def _tables(topic: Topic[Any], origin: pl.DataFrame, messages: list[Message]) -> list[Rows]:
    fields = [field for field in topic.message.DESCRIPTOR.fields if not is_nested(field)]
    own = origin.with_columns(column(field, messages).alias(field.name) for field in fields)
    nested = [
        Rows(name, nested_table(origin, topic.message, messages, name))
        for name in nested_names(topic.message)
    ]
    return [Rows(TABLE_OF[topic], own), *nested]
