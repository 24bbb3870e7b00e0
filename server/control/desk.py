"""Where people's orders and questions come in, and are answered: between two batches of a live run."""

from __future__ import annotations

from typing import TypeVar

from google.protobuf.message import Message

from server.conductor.conductor import Conductor
from server.conductor.prompts import Prompts
from server.conductor.run_control import RunControl
from server.control.status_board import StatusBoard
from server.hubs.hub import Batch
from server.reporter import Reporter
from swarm.messages import swarm_pb2 as pb
from swarm.messages.topics import ESTOP, OPERATOR_ORDER, RUN_STATUS
from swarm.messages.validation import BadMessageError, decode
from swarm.runtime.subscription import Subscription, Subscriptions
from swarm.runtime.zenoh_session import Session

M = TypeVar("M", bound=Message)


class Desk:
    """Serves everybody who asks; emergency stops are heard with the batches."""

    def __init__(
        self,
        session: Session,
        control: RunControl,
        board: StatusBoard,
        prompts: Prompts,
        conductor: Conductor,
        reporter: Reporter,
    ) -> None:
        self._orders = session.questions(OPERATOR_ORDER)
        self._questions = session.questions(RUN_STATUS)
        self._control = control
        self._board = board
        self._prompts = prompts
        self._conductor = conductor
        self._reporter = reporter
        self._estops = Subscription(ESTOP)
        self._heard = Subscriptions([self._estops])

    def step(self, batch: Batch) -> None:
        """Take in a batch, and serve whoever has asked since the last."""
        self._heard.put(batch.items)
        for stop in self._estops.take():
            self._control.emergency(stop.message)
        self._board.take_in(batch, self._conductor)
        for asked in self._prompts.look(self._board.poses(), batch.t_ns):
            self._reporter.event("carried", f"prompt {asked.number}: {asked.robot} stands at its place")
        self.serve()

    def serve(self) -> None:
        """Answer whoever has asked."""
        for order in self._orders.poll():
            order.answer(self._answered(order.payload).SerializeToString())
        for question in self._questions.poll():
            control = self._control
            status = self._board.snapshot(self._conductor, control.paused_robots, control.reason)
            question.answer(status.SerializeToString())

    def _answered(self, payload: bytes) -> pb.OrderAnswer:
        try:
            return self._control.obey(decode(pb.OperatorOrder, payload))
        except BadMessageError as error:
            return pb.OrderAnswer(accepted=False, text=f"not an order: {error}")
