"""Headers and plausibility: what arrives is looked at before it is believed."""

from __future__ import annotations

import math
from contextlib import suppress

import pytest
from google.protobuf.message import Message
from hypothesis import given
from hypothesis import strategies as st

from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.messages.topics import TABLE
from swarm.messages.validation import MAX_PAYLOAD_BYTES, BadMessageError, check, decode


def test_a_header_survives_the_wire() -> None:
    header = Header(2**63, 7, -5)
    assert len(header.pack()) == 24
    assert Header.unpack(header.pack()) == header


@pytest.mark.parametrize("data", [b"", b"x" * 23, b"x" * 25])
def test_what_is_no_header_is_none(data: bytes) -> None:
    assert Header.unpack(data) is None


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (pb.Pose(x_m=math.nan), "Pose.x_m is nan"),
        (pb.Pose(y_m=math.inf), "Pose.y_m is inf"),
        (pb.Pose(x_m=1500.0), "is it in millimetres?"),
        (pb.Pose(theta_rad=90.0), "is it in degrees?"),
        (pb.Pose(captured_t_ns=-1), "a time before the run"),
        (pb.Command(left_steps_per_s=-1e5), "steps/s"),
        (pb.Move(duration_s=2.4e9), "is it in milliseconds?"),
    ],
)
def test_implausible_values_are_refused_by_name(message: Message, said: str) -> None:
    with pytest.raises(BadMessageError) as error:
        check(message)
    assert said in str(error.value)


@pytest.mark.parametrize(
    "message", [pb.Order, pb.RunState, pb.Visit, pb.Event], ids=lambda kind: kind.__name__
)
def test_a_kind_is_said_or_the_message_is_refused(message: type[Message]) -> None:
    """A robot halted, or all of them, on a message that said nothing (kind 0) or nothing known (99)."""
    ((name, kinds),) = (
        (field.name, field.enum_type) for field in message.DESCRIPTOR.fields if field.enum_type
    )
    known = {value.number for value in kinds.values} - {0}
    assert known
    for number in range(-1, 100):
        payload = message(**{name: number}).SerializeToString()
        if number in known:
            assert getattr(decode(message, payload), name) == number
        else:
            with pytest.raises(BadMessageError):
                decode(message, payload)


def test_what_else_a_message_says_does_not_stand_for_its_kind() -> None:
    with pytest.raises(BadMessageError, match=r"Order.kind is 0: it has to be said, by one of RUN, PAUSE"):
        decode(pb.Order, pb.Order(visit=3, reason="lunch").SerializeToString())


def test_an_empty_payload_is_no_message() -> None:
    empty = {topic.message.__name__ for topic in TABLE if not _refused(topic.message, b"")}
    assert empty == {"Command"}, "the robot stands, before it knows where"


def _refused(message: type[Message], payload: bytes) -> bool:
    try:
        decode(message, payload)
    except BadMessageError:
        return True
    return False


def test_plausible_values_pass() -> None:
    check(pb.Pose(x_m=1.2, y_m=-0.1, theta_rad=-3.1, captured_t_ns=10**18))
    check(pb.Command(left_steps_per_s=1100.0, right_steps_per_s=-1100.0))


def test_a_payload_is_measured_before_it_is_decoded() -> None:
    with pytest.raises(BadMessageError, match=f"at most {MAX_PAYLOAD_BYTES}"):
        decode(pb.Event, bytes(MAX_PAYLOAD_BYTES + 1))


@given(st.binary(max_size=200))
def test_bytes_are_refused_or_give_a_plausible_message(payload: bytes) -> None:
    for topic in TABLE:
        with suppress(BadMessageError):
            check(decode(topic.message, payload))
