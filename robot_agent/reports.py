"""All that a robot says, each message under the robot's own key."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from google.protobuf.message import Message

from robot_agent.drivers.health import BodyHealth
from robot_agent.drivers.kinematics import WheelSpeeds
from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.learning.learner import MoveRecord, ReplayRecord
from swarm.learning.memory import ObservedPath
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.runtime.node import Node

M = TypeVar("M", bound=Message)

STATUS_PERIOD_NS = NS_PER_S
"""The rate of status messages in docs/keys.md."""
LONGEST_AGE_S = 1e5
"""Above a day, longer than any run: a pose that never came, in a message that holds finite numbers only."""


class Reporter:
    """Publishes for one robot."""

    def __init__(self, node: Node, robot: str) -> None:
        self._node = node
        self._robot = robot
        self._status_due_ns = 0

    def command(self, sent: WheelSpeeds, pose: Pose | None) -> None:
        """Wheel speeds as sent, and the pose that the robot believes (0, 0, 0 before the first fix)."""
        believed = pose or Pose(0.0, 0.0, 0.0)
        message = pb.Command(
            left_steps_per_s=sent.left_steps_per_s,
            right_steps_per_s=sent.right_steps_per_s,
            x_m=believed.x_m,
            y_m=believed.y_m,
            theta_rad=believed.theta_rad,
        )
        self._publish(topics.COMMAND, message)

    def status(
        self,
        t_ns: int,
        activity: str,
        moves: int,
        tracks: int,
        pose_age_s: float,
        bad_messages: int,
        health: BodyHealth | None = None,
        *,
        paused: bool = False,
        estopped: bool = False,
    ) -> None:
        """Once a second; a pose that never came counts as 100,000 s old. Real robots tell how they do."""
        if t_ns < self._status_due_ns:
            return
        self._status_due_ns = t_ns + STATUS_PERIOD_NS
        message = pb.Status(
            activity=activity,
            moves=moves,
            tracks=tracks,
            pose_age_s=min(pose_age_s, LONGEST_AGE_S),
            bad_messages=bad_messages,
            paused=paused,
            estopped=estopped,
        )
        if health:
            _tell_health(message, health)
        self._publish(topics.STATUS, message)

    def info(self, name: str, text: str) -> None:
        """Something that a person should be able to read in the log."""
        self._publish(topics.EVENT, pb.Event(level=pb.Event.INFO, name=name, text=text))

    def warning(self, name: str, text: str) -> None:
        """Something that a person should look at."""
        self._publish(topics.EVENT, pb.Event(level=pb.Event.WARNING, name=name, text=text))

    def move(self, move: MoveRecord) -> None:
        """What came of a move."""
        made = move.transition
        message = pb.Move(
            number=move.number,
            track=move.track,
            state=made.state,
            action=made.action,
            next_state=made.next_state,
            reward=move.reward,
            duration_s=made.duration_s,
            q_value=move.q_value,
            q_change=move.q_change,
            blocked=made.blocked,
            path=move.path,
        )
        self._publish(topics.MOVE, message)

    def replay(self, replay: ReplayRecord) -> None:
        """How the replay of a path ended."""
        message = pb.Replay(
            path=replay.path,
            moves=replay.moves,
            outcome=replay.outcome.value,
            q_change=replay.q_change,
            ratio=replay.ratio,
            started_move=replay.started_move,
        )
        self._publish(topics.REPLAY, message)

    def best_path(self, move: int, length: int, cap: int) -> None:
        """The greedy path's length after a move; one that does not arrive counts as `cap`."""
        self._publish(topics.BEST_PATH, pb.BestPath(move=move, length=length, cap=cap))

    def path(self, number: int, path: ObservedPath, source: str, visit: int) -> None:
        """A path that entered the memory; `source` is "given" or "camera"."""
        message = pb.PathRemembered(path=number, moves=path.moves, source=source, visit=visit)
        self._publish(topics.PATH, message)

    def accessed_path(self, number: int) -> None:
        """Another's internal state entered the memory, as a path whose moves it decides (section 2.4)."""
        self._publish(topics.PATH, pb.PathRemembered(path=number, source="access"))

    def best_moves(self, move: int, best: Iterable[Iterable[int]]) -> None:
        """The best actions of every state, to whoever may access them."""
        bits = [sum(1 << action for action in actions) for actions in best]
        self._publish(topics.BEST_MOVES, pb.BestMoves(move=move, best=bits))

    def observation(self, observation: pb.Observation) -> None:
        """Where a copied path comes from, frame by frame."""
        self._publish(topics.OBSERVATION, observation)

    def visit(self, number: int, phase: pb.Visit.Phase.ValueType, path: int = 0, reason: str = "") -> None:
        """How far a visit is; at its end the path that was remembered, or why there is none."""
        message = pb.Visit(visit=number, phase=phase, path=path, reason=reason)
        self._publish(topics.VISIT, message)

    def _publish(self, topic: Topic[M], message: M) -> None:
        self._node.publish(topic, message, self._robot)


def _tell_health(message: pb.Status, health: BodyHealth) -> None:
    """The fields that only real robots have."""
    message.battery_v = health.battery_v
    message.proximity.extend(health.proximity)
    message.reading_age_s = min(health.reading_age_s, LONGEST_AGE_S)
    message.failed_exchanges = health.failed_exchanges
    message.refused_readings = health.refused_readings
    message.refused_commands = health.refused_commands
