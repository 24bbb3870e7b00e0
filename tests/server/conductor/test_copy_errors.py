"""The copying error: what was copied against what the demonstrator really did in that time."""

from __future__ import annotations

from typing import Any

from google.protobuf.message import Message

from server.conductor.copy_errors import LAST_MOVE_REPORTED_NS, CopyErrors
from swarm.clock import NS_PER_S
from swarm.geometry import Move
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic

MOVE_S = 2.0


class Judge:
    """Copying errors of a pupil that watches an expert, and what was published of them."""

    def __init__(self) -> None:
        self.published: list[tuple[Topic[Any], Message, str]] = []
        self.errors = CopyErrors({"pupil": "expert"}, lambda *message: self.published.append(message))

    def moved(self, arrived_s: float, move: Move, *, robot: str = "expert", blocked: bool = False) -> None:
        message = pb.Move(action=int(move), duration_s=MOVE_S, blocked=blocked)
        self.errors.moved(robot, message, round(arrived_s * NS_PER_S))

    def observed(self, copied: list[Move], began_s: float, ended_s: float, visit: int = 1) -> None:
        observation = pb.Observation(visit=visit, moves=map(int, copied))
        observation.segments.add(
            began_t_ns=round(began_s * NS_PER_S), ended_t_ns=round(ended_s * NS_PER_S), length_m=1.0
        )
        self.errors.observed("pupil", observation)

    def done(self, t_s: float, visit: int = 1, path: int = 4) -> None:
        self.errors.visit_done("pupil", pb.Visit(visit=visit, path=path), round(t_s * NS_PER_S))

    def judged(self, t_s: float) -> list[pb.CopyError]:
        self.errors.step(round(t_s * NS_PER_S))
        assert all(topic is topics.COPY_ERROR and robot == "pupil" for topic, _, robot in self.published)
        return [message for _, message, _ in self.published if isinstance(message, pb.CopyError)]


def test_only_moves_in_the_copied_time_count() -> None:
    """By their middles: one at 3 s is out, those at 5, 7 and 9 s are in, one at 11 s is out."""
    judge = Judge()
    for arrived_s, move in ((4, Move.N), (6, Move.SE), (8, Move.E), (10, Move.S), (12, Move.N)):
        judge.moved(arrived_s, move)
    judge.observed([Move.SE, Move.SE, Move.S], began_s=4.1, ended_s=10.1)
    judge.done(12)
    (error,) = judge.judged(20)
    assert list(error.true_moves) == [Move.SE, Move.E, Move.S]
    assert list(error.copied_moves) == [Move.SE, Move.SE, Move.S]
    assert (error.visit, error.path, error.demonstrator, error.edit_distance) == (1, 4, "expert", 1)


def test_a_move_into_a_wall_cannot_be_seen_and_does_not_count() -> None:
    judge = Judge()
    judge.moved(6, Move.SE)
    judge.moved(8, Move.N, blocked=True)
    judge.moved(10, Move.S)
    judge.observed([Move.SE, Move.S], began_s=4, ended_s=10)
    judge.done(12)
    assert [error.edit_distance for error in judge.judged(20)] == [0]


def test_it_waits_until_the_last_move_has_been_reported() -> None:
    """The demonstrator reports a move when it has arrived: that may be after the visit."""
    judge = Judge()
    judge.moved(6, Move.SE)
    judge.observed([Move.SE, Move.S], began_s=4, ended_s=8)
    judge.done(8)
    assert judge.judged(8) == []
    judge.moved(8.1, Move.S)
    assert judge.judged(8 + LAST_MOVE_REPORTED_NS / NS_PER_S - 0.1) == []
    (error,) = judge.judged(8 + LAST_MOVE_REPORTED_NS / NS_PER_S)
    assert error.edit_distance == 0
    assert len(judge.judged(100)) == 1, "it is judged once"


def test_an_observation_without_a_copy_is_not_judged() -> None:
    judge = Judge()
    judge.errors.observed("pupil", pb.Observation(visit=1, reason="the image is dark"))
    judge.done(10, path=0)
    assert judge.judged(100) == []


def test_an_observation_of_another_visit_is_not_judged() -> None:
    judge = Judge()
    judge.observed([Move.SE], began_s=4, ended_s=6, visit=1)
    judge.done(10, visit=2)
    assert judge.judged(100) == []


def test_other_robots_moves_do_not_count() -> None:
    judge = Judge()
    judge.moved(6, Move.N, robot="loner")
    judge.moved(6, Move.SE)
    judge.observed([Move.SE], began_s=4, ended_s=6)
    judge.done(10)
    assert [list(error.true_moves) for error in judge.judged(20)] == [[Move.SE]]
