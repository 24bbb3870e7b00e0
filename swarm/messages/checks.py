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
    for name, limit, hint in _limits(message.DESCRIPTOR):
        value = getattr(message, name)
        if not -limit <= value <= limit:
            raise BadMessageError(f"{message.DESCRIPTOR.name}.{name} is {value!r}: not plausible ({hint})")
        if name.endswith("t_ns") and value < 0:
            raise BadMessageError(f"{message.DESCRIPTOR.name}.{name} is {value}: a time before the run")


@cache
def _limits(descriptor: Descriptor) -> tuple[tuple[str, float, str], ...]:
    """(field, largest magnitude, hint) for each number of a message type."""
    limits = []
    for field in descriptor.fields:
        if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
            limits.append((field.name, *_range_of(field.name)))
        elif field.name.endswith("t_ns"):
            limits.append((field.name, MAX_T_NS, "nanoseconds"))
    return tuple(limits)


def _range_of(name: str) -> tuple[float, str]:
    return next(
        (bounds for suffix, bounds in _RANGES.items() if name.endswith(suffix)), (1e6, "a finite number")
    )
