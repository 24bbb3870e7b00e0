"""Before a process does anything it learns whose run it is in, and leaves if it came for another one."""

from __future__ import annotations

import sys
from collections.abc import Callable

from swarm.clock import WallClock
from swarm.errors import UserError
from swarm.messages.topics import RUN_IDENTITY
from swarm.runtime.identity import RunIdentity, shown
from swarm.runtime.zenoh_session import Session

ANSWER_WITHIN_S = 1.0
"""A server on the other side of a bad radio link answers within a tenth of this."""
BETWEEN_QUESTIONS_S = 0.2
QUESTIONS_IN_SILENCE = 25
"""Five seconds: a server that is there answers the first."""
UNANSWERED = (
    "waiting for a server that says whose run this is (one that is there does not answer a certificate that "
    "was renewed or revoked)"
)


def agreed_run(
    session: Session, mine: RunIdentity, clock: WallClock, going_on: Callable[[], None] = lambda: None
) -> str:
    """The id of the server's run, once the server answers; UserError if it is not the one `mine` tells of.

    `going_on` is called before every question.
    """
    for question, _ in enumerate(clock.ticks(BETWEEN_QUESTIONS_S)):
        going_on()
        if answers := session.ask(RUN_IDENTITY, ANSWER_WITHIN_S):
            return compared(answers[0], mine)
        if question == QUESTIONS_IN_SILENCE:
            print(UNANSWERED, file=sys.stderr, flush=True)
    raise AssertionError("a clock has no last tick")


def compared(answer: bytes, mine: RunIdentity) -> str:
    """The run's id that a server answered; UserError with everything that differs."""
    try:
        run = RunIdentity.unpack(answer)
    except ValueError as error:
        raise UserError(
            f"the server does not say whose run this is ({error}): is it of this version?"
        ) from error
    differences = mine.differences(run)
    if differences:
        raise UserError(
            f"the server's run {run.run_id} is not this process's: {shown(differences)}; "
            "start both with the same experiment file, --seed, --moves, --trial and version"
        )
    return run.run_id
