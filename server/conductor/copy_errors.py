"""The copying error: what a robot copied against what the demonstrator really did meanwhile.

Only the server can know it; no robot ever hears of it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.learning.alignment import edit_distance
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics

MOVES_KEPT = 1000
"""More than the longest visit, of 600 s, has room for: no move takes less than a second."""
LAST_MOVE_REPORTED_NS = 5 * NS_PER_S
"""A move is reported when it ends: two of the mean move of 2.4 s. Nobody waits for this."""


@dataclass(frozen=True, slots=True)
class RealMove:
    """A move that was driven: when its middle was, and which it is."""

    middle_t_ns: int
    move: int


class CopyErrors:
    """Keeps the demonstrators' moves and judges every observation."""

    def __init__(self, watched_by: dict[str, str], reporter: Reporter) -> None:
        self._watched_by = watched_by
        self._reporter = reporter
        self._real = {robot: deque[RealMove](maxlen=MOVES_KEPT) for robot in watched_by.values()}
        self._observations: dict[str, pb.Observation] = {}
        self._to_judge: deque[tuple[int, str, pb.Visit, pb.Observation]] = deque()

    def moved(self, robot: str, move: pb.Move, arrived_t_ns: int) -> None:
        """A robot made a move; one into a wall is not driven, so nobody can see it."""
        if robot in self._real and not move.blocked:
            middle_t_ns = arrived_t_ns - round(move.duration_s * NS_PER_S / 2)
            self._real[robot].append(RealMove(middle_t_ns, move.action))

    def observed(self, robot: str, observation: pb.Observation) -> None:
        """A robot tells how it copied; the path's number comes when the visit is done."""
        self._observations[robot] = observation

    def visit_done(self, robot: str, visit: pb.Visit, t_ns: int) -> None:
        """Have the visit's observation judged, if it copied anything, once its last move is reported."""
        observation = self._observations.pop(robot, None)
        if observation and observation.segments and observation.visit == visit.visit:
            self._to_judge.append((t_ns + LAST_MOVE_REPORTED_NS, robot, visit, observation))

    def step(self, t_ns: int) -> None:
        """Judge what is due."""
        while self._to_judge and self._to_judge[0][0] <= t_ns:
            _, robot, visit, observation = self._to_judge.popleft()
            self._judge(robot, visit, observation)

    def _judge(self, robot: str, visit: pb.Visit, observation: pb.Observation) -> None:
        demonstrator = self._watched_by[robot]
        began_t_ns = observation.segments[0].began_t_ns
        ended_t_ns = observation.segments[-1].ended_t_ns
        real = [
            entry.move for entry in self._real[demonstrator] if began_t_ns <= entry.middle_t_ns <= ended_t_ns
        ]
        copied = list(observation.moves)
        message = pb.CopyError(
            visit=visit.visit,
            path=visit.path,
            demonstrator=demonstrator,
            true_moves=real,
            copied_moves=copied,
            edit_distance=edit_distance(copied, real),
        )
        self._reporter.publish(topics.COPY_ERROR, message, robot)
