"""Plausibility of what arrives: sizes before decoding, then every number by the unit in its name."""

from __future__ import annotations

import math
from functools import cache
from typing import TypeVar

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import DecodeError, Message

from swarm.messages import swarm_pb2 as pb

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
    """Decode and check a payload; BadMessageError names the field that is wrong.

    An empty payload is a message whose values are all 0. Only a command can mean that: a robot that stands,
    and does not know yet where.
    """
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise BadMessageError(f"{len(payload)} bytes; at most {MAX_PAYLOAD_BYTES} are read")
    if not payload and message_type is not pb.Command:
        raise BadMessageError(f"an empty {message_type.__name__} says nothing")
    try:
        message = message_type.FromString(payload)
    except DecodeError as error:
        raise BadMessageError(f"no {message_type.__name__}: {error}") from error
    check(message)
    return message


def check(message: Message) -> None:
    """BadMessageError unless every float is finite and plausible, every time positive, every kind known."""
    singles, lists, parts, kinds = _fields(message.DESCRIPTOR)
    for name, known in kinds:
        if getattr(message, name) not in known:
            raise BadMessageError(
                f"{message.DESCRIPTOR.name}.{name} is {getattr(message, name)}: it has to be said, by one of "
                f"{', '.join(known.values())}"
            )
    for name, low, high, hint in singles:
        value = getattr(message, name)
        if not low <= value <= high:
            raise _not_plausible(message, name, value, hint)
    for name, low, high, hint in lists:
        for value in getattr(message, name):
            if not low <= value <= high:
                raise _not_plausible(message, name, value, hint)
    for name in parts:
        for part in getattr(message, name):
            check(part)


def _not_plausible(message: Message, name: str, value: float, hint: str) -> BadMessageError:
    return BadMessageError(f"{message.DESCRIPTOR.name}.{name} is {value!r}: not plausible ({hint})")


Limits = tuple[tuple[str, float, float, str], ...]
Kinds = tuple[tuple[str, dict[int, str]], ...]


@cache
def _fields(descriptor: Descriptor) -> tuple[Limits, Limits, tuple[str, ...], Kinds]:
    """A message type's single numbers, lists of numbers, lists of messages, and kinds.

    A number's limits are its name, the lowest and highest that it may be, and a hint. A kind's are its name
    and what it may be: never 0, which is what an enumeration is if nobody said anything.
    """
    parts = tuple(
        field.name
        for field in descriptor.fields
        if field.is_repeated and field.cpp_type == FieldDescriptor.CPPTYPE_MESSAGE
    )
    kinds = tuple(
        (field.name, {value.number: value.name for value in field.enum_type.values if value.number})
        for field in descriptor.fields
        if field.enum_type is not None
    )
    return _limits(descriptor, repeated=False), _limits(descriptor, repeated=True), parts, kinds


def _limits(descriptor: Descriptor, *, repeated: bool) -> Limits:
    limits: list[tuple[str, float, float, str]] = []
    for field in descriptor.fields:
        if field.is_repeated != repeated:
            continue
        if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
            largest, hint = _range_of(field.name)
            limits.append((field.name, -largest, largest, hint))
        elif field.name.endswith("t_ns"):
            limits.append((field.name, 0, MAX_T_NS, "a time before the run, or not in nanoseconds"))
    return tuple(limits)


def _range_of(name: str) -> tuple[float, str]:
    return next(
        (bounds for suffix, bounds in _RANGES.items() if name.endswith(suffix)), (1e6, "a finite number")
    )
