"""Section 2.4: a robot that may access another's internal state, which crosses from one to the other."""

from __future__ import annotations

from swarm.geometry import MOVES
from swarm.learning.memory import AccessedPolicy
from swarm.learning.q_table import QTable
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.subscription import Subscription


class AccessedRobot:
    """The other's newest estimate of the best moves, as a path for the memory."""

    def __init__(self, told: Subscription[pb.BestMoves], states: int) -> None:
        self._told = told
        self._best = QTable(states)
        self._is_known = False
        self.path = AccessedPolicy(self._best)
        """Decides anew in every state, by what was told last."""

    def first_heard(self) -> bool:
        """Take in what the other has told; True once, when there is something to remember."""
        news = [received.message for received in self._told.take()]
        fitting = [message for message in news if len(message.best) == len(self._best.values)]
        if not fitting:
            return False
        self._best.values = [_indicated(bits) for bits in fitting[-1].best]
        first, self._is_known = not self._is_known, True
        return first


def _indicated(bits: int) -> list[float]:
    """Values whose highest are those of the actions that the bits name."""
    return [float(bits >> action & 1) for action in range(MOVES)]
