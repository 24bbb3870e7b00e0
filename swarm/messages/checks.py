"""Plausibility of what arrives: sizes before decoding, then every number by the unit in its name."""

from __future__ import annotations

import math
from functools import cache
from typing import TypeVar

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import DecodeError, Message

MAX_PAYLOAD_BYTES = 65_536
MAX_T_NS = 2**62

M = TypeVar("M", bound=Message)

_RANGES = {
    "_steps_per_s": (2_000.0, "steps/s; an e-puck's wheels make at most 1100"),
    "_m": (100.0, "metres; is it in millimetres?"),
    "_rad": (2 * math.pi, "radians; is it in degrees?"),
    "_s": (1e6, "seconds; is it in milliseconds?"),
}


class BadMessageError(ValueError):
    """A payload that cannot be what its key promises; the text says why."""


def decode(message_type: type[M], payload: bytes) -> M:
    """Decode and check a payload; BadMessageError names the field that is wrong."""
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise BadMessageError(f"{len(payload)} bytes; at most {MAX_PAYLOAD_BYTES} are read")
    try:
        message = message_type.FromString(payload)
    except DecodeError as error:
        raise BadMessageError(f"no {message_type.__name__}: {error}") from error
    check(message)
    return message


def check(message: Message) -> None:
    """BadMessageError unless every float is finite and plausible and every time is positive."""
    for name, limit, hint in _numbers(message.DESCRIPTOR):
        _check_number(message, name, getattr(message, name), limit, hint)
    for name, limit, hint in _lists(message.DESCRIPTOR):
        for value in getattr(message, name):
            _check_number(message, name, value, limit, hint)
    for name in _message_lists(message.DESCRIPTOR):
        for part in getattr(message, name):
            check(part)


def _check_number(message: Message, name: str, value: float, limit: float, hint: str) -> None:
    if not -limit <= value <= limit:
        raise BadMessageError(f"{message.DESCRIPTOR.name}.{name} is {value!r}: not plausible ({hint})")
    if value < 0 and name.endswith("t_ns"):
        raise BadMessageError(f"{message.DESCRIPTOR.name}.{name} is {value}: a time before the run")


Numbers = tuple[tuple[str, float, str], ...]


@cache
def _numbers(descriptor: Descriptor) -> Numbers:
    """(field, largest magnitude, hint) of each single number of a message type."""
    return _limits(descriptor, repeated=False)


@cache
def _lists(descriptor: Descriptor) -> Numbers:
    return _limits(descriptor, repeated=True)


@cache
def _message_lists(descriptor: Descriptor) -> tuple[str, ...]:
    kind = FieldDescriptor.CPPTYPE_MESSAGE
    return tuple(field.name for field in descriptor.fields if field.is_repeated and field.cpp_type == kind)


def _limits(descriptor: Descriptor, *, repeated: bool) -> Numbers:
    limits = []
    for field in descriptor.fields:
        if field.is_repeated != repeated:
            continue
        if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
            limits.append((field.name, *_range_of(field.name)))
        elif field.name.endswith("t_ns"):
            limits.append((field.name, MAX_T_NS, "nanoseconds"))
    return tuple(limits)


def _range_of(name: str) -> tuple[float, str]:
    return next(
        (bounds for suffix, bounds in _RANGES.items() if name.endswith(suffix)), (1e6, "a finite number")
    )
