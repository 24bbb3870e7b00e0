"""A field of many messages as a typed column: numbers, texts, lists, and lists of structures.

Enumerations become their names. Counts become signed, because differences of unsigned columns wrap around.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import polars as pl
from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message

_TYPES: dict[int, Any] = {
    FieldDescriptor.CPPTYPE_DOUBLE: pl.Float64(),
    FieldDescriptor.CPPTYPE_FLOAT: pl.Float64(),
    FieldDescriptor.CPPTYPE_BOOL: pl.Boolean(),
    FieldDescriptor.CPPTYPE_ENUM: pl.String(),
    FieldDescriptor.CPPTYPE_UINT64: pl.UInt64(),
}
_ARRAYS: dict[int, Any] = {
    FieldDescriptor.CPPTYPE_DOUBLE: np.float64,
    FieldDescriptor.CPPTYPE_BOOL: np.bool_,
    FieldDescriptor.CPPTYPE_INT32: np.int64,
    FieldDescriptor.CPPTYPE_INT64: np.int64,
    FieldDescriptor.CPPTYPE_UINT32: np.int64,
}
"""Single numbers of these kinds, the bulk of every log, take the short way."""


def column(field: Any, messages: Sequence[Message]) -> pl.Series:
    """The values of a field, of a message descriptor's `fields`, in all messages."""
    values = (getattr(message, field.name) for message in messages)
    if not field.is_repeated and field.cpp_type in _ARRAYS:
        return pl.Series(np.fromiter(values, dtype=_ARRAYS[field.cpp_type], count=len(messages)))
    return pl.Series([_plain(field, value) for value in values], dtype=_type(field))


def _type(field: Any) -> Any:
    single = _single_type(field)
    return pl.List(single) if field.is_repeated else single


def _single_type(field: Any) -> Any:
    if field.message_type is not None:
        return pl.Struct({inner.name: _type(inner) for inner in field.message_type.fields})
    if field.type == FieldDescriptor.TYPE_BYTES:
        return pl.Binary()
    if field.cpp_type == FieldDescriptor.CPPTYPE_STRING:
        return pl.String()
    return _TYPES.get(field.cpp_type, pl.Int64())


def _plain(field: Any, value: Any) -> Any:
    return [_single(field, item) for item in value] if field.is_repeated else _single(field, value)


def _single(field: Any, value: Any) -> Any:
    if field.message_type is not None:
        return {inner.name: _plain(inner, getattr(value, inner.name)) for inner in field.message_type.fields}
    if field.enum_type is not None:
        named = field.enum_type.values_by_number.get(value)
        return named.name if named else str(value)
    return value
