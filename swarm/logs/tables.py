"""Messages to tables: a row for each message, a column for each field; nested lists become tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
import polars as pl
from google.protobuf.message import Message

from swarm.geometry import Move
from swarm.logs.columns import column
from swarm.logs.identity import LogIdentity
from swarm.logs.reader import S_PER_NS, LogChannel, Part
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.messages.validation import BadMessageError, decode

LEARNING: dict[Topic[Any], str] = {
    topics.MOVE: "moves",
    topics.BEST_PATH: "best_paths",
    topics.PATH: "paths",
    topics.REPLAY: "replays",
    topics.EVENT: "events",
    topics.TRACKER_EVENT: "events",
    topics.SERVER_EVENT: "events",
    topics.ORDER: "orders",
    topics.RUN_STATE: "run_states",
    topics.STATUS: "statuses",
    topics.CARRY: "carries",
}
"""What is said about learning and about the run: small, always read."""
WATCHING: dict[Topic[Any], str] = {
    topics.VISIT: "visit_phases",
    topics.OBSERVATION: "observations",
    topics.COPY_ERROR: "copy_errors",
}
"""What is said about visits; a run without visits has none of these tables."""
SAMPLED: dict[Topic[Any], str] = {topics.POSE: "poses", topics.COMMAND: "commands", topics.TRUTH: "truths"}
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
    return PartRows(_tables(topic, origin, messages, identity.grid.columns), rejected)


def empty_table(table: str) -> pl.DataFrame:
    """A table without rows, with the columns that it would have."""
    topic = next(topic for topic in TABLE_OF if table in table_names([topic]))
    types: dict[str, Any] = dict.fromkeys(("log", "condition", "robot"), pl.String) | {"t_s": pl.Float64}
    origin = pl.DataFrame({name: pl.Series([], dtype=types.get(name, pl.Int64)) for name in _ORIGIN})
    return next(found.frame for found in _tables(topic, origin, [], 1) if found.table == table)


_ORIGIN = (
    "log",
    "seed",
    "trial",
    "condition",
    "robot",
    "t_s",
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
    publisher = part.channel.publisher

    def constant(value: str | int) -> pl.Series:
        return pl.repeat(
            value, len(sequence), dtype=pl.String if isinstance(value, str) else pl.Int64, eager=True
        )

    return {
        "log": constant(identity.trial_log),
        "seed": constant(identity.seed),
        "trial": constant(identity.trial),
        "condition": constant(identity.condition(publisher)),
        "robot": constant(publisher),
        "t_s": pl.Series(part.publish_t_ns[good] * S_PER_NS, dtype=pl.Float64),
        "epoch": constant(part.channel.epoch),
        "sequence": pl.Series(sequence),
        "publish_t_ns": pl.Series(part.publish_t_ns[good]),
        "receive_t_ns": pl.Series(part.receive_t_ns[good]),
    }


def _tables(
    topic: Topic[Any], origin: pl.DataFrame, messages: list[Message], grid_columns: int
) -> list[Rows]:
    fields = [field for field in topic.message.DESCRIPTOR.fields if not is_nested(field)]
    own = origin.with_columns(column(field, messages).alias(field.name) for field in fields)
    nested = [
        Rows(name, nested_table(origin, topic.message, messages, name))
        for name in nested_names(topic.message)
    ]
    return [Rows(TABLE_OF[topic], _readable(own, grid_columns)), *nested]


_BY_COMPASS = ("action", "moves", "window", "true_moves", "copied_moves")
"""Moves by number in the messages; `moves` only where it is a list, else it is a count."""


def _readable(frame: pl.DataFrame, grid_columns: int) -> pl.DataFrame:
    """Moves by their compass names, and beside each state its column and row."""
    types = frame.schema
    named = [
        _compass_names(pl.col(name), types[name])
        for name in _BY_COMPASS
        if name in types and (name != "moves" or types[name].is_nested())
    ]
    for prefix in ("", "next_"):
        if f"{prefix}state" in types:
            state = pl.col(f"{prefix}state")
            named += [(state % grid_columns).alias(f"{prefix}column")]
            named += [(state // grid_columns).alias(f"{prefix}row")]
    return frame.with_columns(named)


def _compass_names(moves: pl.Expr, of_type: pl.DataType) -> pl.Expr:
    """Null for a number that is no move."""
    names = {int(move): move.name for move in Move}

    def named(numbers: pl.Expr) -> pl.Expr:
        return numbers.replace_strict(names, default=None, return_dtype=pl.String)

    return moves.list.eval(named(pl.element())) if of_type.is_nested() else named(moves)


PLACE = "place"
"""The column that counts the rows of one message from 0."""
_VISIT = "visit"


def is_nested(field: Any) -> bool:
    """Whether a field, of a message descriptor's `fields`, is a list of messages."""
    return field.is_repeated and field.message_type is not None


def nested_names(message_type: type[Message]) -> tuple[str, ...]:
    """The tables that a message's lists of messages become: one for each such field, by its name."""
    return tuple(field.name for field in message_type.DESCRIPTOR.fields if is_nested(field))


def nested_table(
    origin: pl.DataFrame, message_type: type[Message], messages: Sequence[Message], name: str
) -> pl.DataFrame:
    """A row for each item of the list `name` of every message.

    `origin` has a row a message: where it comes from. The items keep that, the visit that the message is
    about, and their place in the list.
    """
    fields: Any = message_type.DESCRIPTOR.fields_by_name
    counts = [len(getattr(message, name)) for message in messages]
    items = [item for message in messages for item in getattr(message, name)]
    owner = np.repeat(np.arange(len(messages)), counts)
    place = np.arange(len(items)) - np.repeat(np.cumsum(counts, dtype=np.int64) - counts, counts)
    columns = {_VISIT: column(fields[_VISIT], messages).gather(owner)} if _VISIT in fields else {}
    columns |= {PLACE: pl.Series(place, dtype=pl.Int64)}
    columns |= {inner.name: column(inner, items) for inner in fields[name].message_type.fields}
    return origin[owner].with_columns(series.alias(title) for title, series in columns.items())
