"""What a person at a terminal or a console says to a run: orders, and the question how it goes."""

from __future__ import annotations

import getpass
import socket
import time
from typing import Any, TypeVar

from google.protobuf.json_format import MessageToDict
from google.protobuf.message import Message

from swarm.clock import unix_clock
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.messages.topics import ESTOP, OPERATOR_ORDER, RUN_STATUS
from swarm.messages.validation import BadMessageError, decode
from swarm.runtime.zenoh_session import Session

M = TypeVar("M", bound=Message)

ANSWER_WITHIN_S = 6.0
"""A server answers at its next tick, 0.1 s. One that waits for a robot to take an order in may wait 5 s."""
QUESTIONS = 10
BETWEEN_QUESTIONS_S = 0.2
"""Together two seconds: a server that has just been started may need them before it can be asked."""
ESTOP_REPEATED = 25
ESTOP_EVERY_S = 0.02
"""Half a second of them. One is enough on a good link; on one that loses packets those that follow tell its
TCP at once what was lost, where it would wait 0.2 s and longer to notice."""


def operator_name() -> str:
    """Who sits at this terminal, as NAME@HOST."""
    return f"{getpass.getuser()}@{socket.gethostname()}"


def send_order(session: Session, order: pb.OperatorOrder) -> pb.OrderAnswer:
    """Give an order, and return what the server did about it.

    An emergency stop goes to all robots directly, before the server is asked to keep it. UserError if no
    server answers, which for an emergency stop does not mean that no robot heard it.
    """
    if order.kind == pb.OperatorOrder.ESTOP:
        publish_estop(session, order)
    ask_status(session)  # An order is given once, and so only to a server that listens.
    return _read(pb.OrderAnswer, session.ask(OPERATOR_ORDER, ANSWER_WITHIN_S, order.SerializeToString()))


def ask_status(session: Session) -> pb.RunStatus:
    """How the run goes now. UserError if no server answers."""
    for _ in zip(range(QUESTIONS), unix_clock().ticks(BETWEEN_QUESTIONS_S), strict=False):
        if answers := session.ask(RUN_STATUS, ANSWER_WITHIN_S):
            break
    return _read(pb.RunStatus, answers)


def status_as_json(status: pb.RunStatus) -> dict[str, Any]:
    """A status by the names of its fields, for programs; times in nanoseconds are texts, as JSON wants it."""
    return MessageToDict(status, preserving_proto_field_name=True, always_print_fields_with_no_presence=True)


def publish_estop(session: Session, order: pb.OperatorOrder) -> None:
    """Tell everyone to stop. Each emergency has an epoch of its own, so that none looks like an old one."""
    message = pb.EmergencyStop(operator=order.operator, reason=order.reason).SerializeToString()
    publisher = session.publisher(ESTOP.key(""), ESTOP.delivery)
    epoch = time.time_ns()
    publisher.put(message, attachment=Header(epoch, 1, epoch).pack())
    for number, t_ns in zip(range(2, ESTOP_REPEATED + 1), unix_clock().ticks(ESTOP_EVERY_S), strict=False):
        publisher.put(message, attachment=Header(epoch, number, t_ns).pack())


def _read(kind: type[M], answers: list[bytes]) -> M:
    if not answers:
        raise UserError("no server of a run answers there: is one running, and does it listen here?")
    try:
        return decode(kind, answers[0])
    except BadMessageError as error:
        raise UserError(f"the server's answer cannot be read ({error}): is it of this version?") from error
