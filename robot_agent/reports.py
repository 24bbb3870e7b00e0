"""What the agent says besides its moves: commands as sent, status, events."""

from __future__ import annotations

from robot_agent.drivers.kinematics import WheelSpeeds
from robot_agent.policies.policy import Policy, Publish
from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics

STATUS_PERIOD_NS = NS_PER_S
LONGEST_AGE_S = 1e5


class Reporter:
    """Publishes under the robot's own keys."""

    def __init__(self, publish: Publish) -> None:
        self._publish = publish
        self._status_due_ns = 0

    def command(self, sent: WheelSpeeds, pose: Pose | None) -> None:
        """Wheel speeds as sent, and the pose that the robot believes (0, 0, 0 before the first fix)."""
        believed = pose or Pose(0.0, 0.0, 0.0)
        self._publish(
            topics.COMMAND,
            pb.Command(
                left_steps_per_s=sent.left_steps_per_s,
                right_steps_per_s=sent.right_steps_per_s,
                x_m=believed.x_m,
                y_m=believed.y_m,
                theta_rad=believed.theta_rad,
            ),
        )

    def status(self, t_ns: int, activity: str, policy: Policy, pose_age_s: float, bad: int) -> None:
        """Once a second; a pose that never came counts as 100,000 s old."""
        if t_ns < self._status_due_ns:
            return
        self._status_due_ns = t_ns + STATUS_PERIOD_NS
        self._publish(
            topics.STATUS,
            pb.Status(
                activity=activity,
                moves=policy.moves,
                tracks=policy.tracks,
                pose_age_s=min(pose_age_s, LONGEST_AGE_S),
                bad_messages=bad,
            ),
        )

    def event(self, name: str, text: str, level: pb.Event.Level.ValueType = pb.Event.WARNING) -> None:
        """Something that a person should be able to read in the log."""
        self._publish(topics.EVENT, pb.Event(level=level, name=name, text=text))
