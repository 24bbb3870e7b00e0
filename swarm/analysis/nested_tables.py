"""Lists of messages inside messages, such as an observation's looks, as tables of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import polars as pl
from google.protobuf.message import Message

from swarm.analysis.columns import column

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
