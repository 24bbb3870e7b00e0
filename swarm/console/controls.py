"""The controls of a live run behind a page: what it waits for, and the orders of whoever may steer."""

from __future__ import annotations

from contextlib import suppress
from threading import Lock
from typing import Any, NamedTuple

from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.operating import ask_status, operator_name, send_order
from swarm.runtime.zenoh_session import Session, SessionSettings

LOOK_EVERY_S = 0.7
"""A person who has given an order sees within a second what became of it."""
ORDERS = ("pause", "resume", "stop", "estop", "release", "done")
MAY_NOT_HAVE_HEARD = "THE ROBOTS MAY NOT HAVE HEARD IT: switch them off by hand"


class Answer(NamedTuple):
    """What became of an order."""

    accepted: bool
    text: str


class Controls:
    """Asks a run's server how it goes, and passes orders on. Orders may come on any thread."""

    def __init__(self, settings: SessionSettings) -> None:
        self._settings = settings
        self._session: Session | None = None
        self._lock = Lock()
        self.status: dict[str, Any] | None = None
        """Phase, reason, who is missing, prompts; None while no server answers."""

    def poll(self) -> bool:
        try:
            self.status = _shown(ask_status(self._opened()))
        except UserError:
            self._leave()
        return False

    def order(self, kind: str, robots: list[str], prompt: int) -> Answer:
        """Give an order and wait for its answer; a server that does not answer is a refusal, too."""
        order = pb.OperatorOrder(
            kind=pb.OperatorOrder.Kind.Value(kind.upper()),
            operator=operator_name(),
            reason="from the console's page",
            robots=robots,
            prompt=prompt,
        )
        try:
            answer = send_order(self._opened(), order)
        except UserError as error:
            self._leave()
            return Answer(False, f"{error} {MAY_NOT_HAVE_HEARD}" if kind == "estop" else str(error))
        with suppress(UserError):
            self.status = _shown(ask_status(self._opened()))
        return Answer(answer.accepted, answer.text)

    def close(self) -> None:
        self._leave()

    def _opened(self) -> Session:
        with self._lock:
            if self._session is None:
                self._session = Session(self._settings)
            return self._session

    def _leave(self) -> None:
        """The next question opens a session of its own: this one's server may have gone."""
        with self._lock:
            self.status = None
            if self._session:
                self._session.close()
            self._session = None


def _shown(status: pb.RunStatus) -> dict[str, Any]:
    return {
        "phase": pb.RunState.Phase.Name(status.phase).lower(),
        "reason": status.reason,
        "missing": list(status.missing),
        "paused": [robot.robot for robot in status.robots if robot.paused],
        "prompts": [
            {"number": prompt.number, "robot": prompt.robot, "text": prompt.text} for prompt in status.prompts
        ],
    }
