"""How the run goes at this moment, for whoever asks: one snapshot of robots, trial, prompts and events."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from server.conductor.conductor import Conductor
from server.conductor.prompts import Prompts
from server.control.time_left import TimeLeft
from server.hubs.hub import Batch
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, RobotSettings
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic, topic_of
from swarm.runtime.identity import RunIdentity
from swarm.runtime.subscription import Subscription, Subscriptions

EVENTS_KEPT = 50
"""A screenful; all of them are in the log."""
RATE_WINDOW_NS = 2 * NS_PER_S
"""Two status messages and twenty commands of each robot."""
LONGEST_AGE_S = 1e5
"""Of what has never been heard, as robots say it of poses: a message holds finite numbers only."""


@dataclass
class Heard:
    """What was heard of one robot."""

    status: pb.Status = field(default_factory=pb.Status)
    pose: Pose | None = None
    t_ns: int | None = None
    count: int = 0
    per_s: float = 0.0


class StatusBoard:
    """Follows what is on the wire beside the conductor, and sums it up when asked."""

    def __init__(
        self,
        experiment: Experiment,
        identity: RunIdentity,
        prompts: Prompts,
        missing: Callable[[], list[str]],
    ) -> None:
        self._experiment = experiment
        self._identity = identity
        self._prompts = prompts
        self._missing = missing
        self._statuses = Subscription(topics.STATUS)
        self._commands = Subscription(topics.COMMAND)
        self._events: dict[Topic[Any], Subscription[pb.Event]] = {
            topic: Subscription(topic) for topic in (topics.EVENT, topics.TRACKER_EVENT, topics.SERVER_EVENT)
        }
        self._subscriptions = Subscriptions((self._statuses, self._commands, *self._events.values()))
        self._robots = {robot.id: Heard() for robot in experiment.robot}
        self._recent: deque[pb.RecentEvent] = deque(maxlen=EVENTS_KEPT)
        self._began_ns: int | None = None
        self._t_ns = 0
        self._rated_ns = 0
        self._time_left = TimeLeft(experiment.run.moves)

    def take_in(self, batch: Batch, conductor: Conductor) -> None:
        """Follow one batch."""
        under_way = conductor.phase == pb.RunState.RUNNING
        self._time_left.step(self._learners(conductor), batch.t_ns, under_way=under_way)
        self._began_ns = batch.t_ns if self._began_ns is None else self._began_ns
        self._t_ns = batch.t_ns
        self._subscriptions.put(batch.items)
        self._count(batch)
        for status in self._statuses.take():
            if status.robot in self._robots:
                self._robots[status.robot].status = status.message
        for command in self._commands.take():
            if command.robot in self._robots:
                believed = command.message
                pose = Pose(believed.x_m, believed.y_m, believed.theta_rad)
                self._robots[command.robot].pose = pose
        for topic, events in self._events.items():
            for event in events.take():
                self._note(event.robot or topic.pattern.split("/")[0], event.message)

    def pose_of(self, robot: str) -> Pose | None:
        """Where a robot believes to be, if it knows and its pose is fresh."""
        heard = self._robots[robot]
        known = heard.pose is not None and 0 < heard.status.pose_age_s < 1.0
        return heard.pose if known else None

    def poses(self) -> dict[str, Pose]:
        """Of all robots that know where they are."""
        found = {robot: self.pose_of(robot) for robot in self._robots}
        return {robot: pose for robot, pose in found.items() if pose is not None}

    def snapshot(self, conductor: Conductor, paused: set[str], reason: str) -> pb.RunStatus:
        """Everything, as it is now."""
        missing = self._missing()
        elapsed_s = (self._t_ns - (self._began_ns or self._t_ns)) / NS_PER_S
        return pb.RunStatus(
            experiment=self._experiment.run.name,
            run_id=self._identity.run_id,
            trial=self._identity.trial,
            phase=conductor.phase if self._began_ns is not None else pb.RunState.PREPARING,
            reason=reason,
            t_ns=self._t_ns,
            elapsed_s=elapsed_s,
            time_left_s=self._time_left.left_s(self._learners(conductor)),
            moves_wanted=self._experiment.run.moves,
            missing=missing,
            robots=[
                self._robot(robot, conductor, robot.id not in missing, robot.id in paused)
                for robot in self._experiment.robot
            ],
            prompts=self._prompts.messages(),
            events=self._recent,
        )

    def _learners(self, conductor: Conductor) -> dict[str, int]:
        """Moves made, by learner."""
        return {robot.id: conductor.moves[robot.id] for robot in self._experiment.learners}

    def _robot(
        self, robot: RobotSettings, conductor: Conductor, present: bool, paused: bool
    ) -> pb.RobotStatus:
        heard = self._robots[robot.id]
        status, pose = heard.status, heard.pose
        age_s = LONGEST_AGE_S if heard.t_ns is None else (self._t_ns - heard.t_ns) / NS_PER_S
        found = pb.RobotStatus(
            robot=robot.id,
            role=robot.role.value,
            condition=robot.group,
            present=present,
            activity=status.activity,
            paused=paused,
            estopped=status.estopped,
            moves=conductor.moves[robot.id],
            tracks=status.tracks,
            best_path=conductor.best_path.get(robot.id, 0),
            battery_v=status.battery_v,
            pose_age_s=status.pose_age_s if status.activity else LONGEST_AGE_S,
            heard_age_s=age_s,
            messages_per_s=heard.per_s,
            reading_age_s=status.reading_age_s,
            failed_exchanges=status.failed_exchanges,
            bad_messages=status.bad_messages,
            has_pose=self.pose_of(robot.id) is not None,
        )
        if pose is not None:
            found.x_m, found.y_m, found.theta_rad = pose.x_m, pose.y_m, pose.theta_rad
        return found

    def _count(self, batch: Batch) -> None:
        """What each robot itself sent, its rate over windows of two seconds."""
        senders = Counter(
            found[1] for item in batch.items if (found := topic_of(item.key)) and is_own(found[0])
        )
        for robot, count in senders.items():
            if robot in self._robots:
                self._robots[robot].count += count
                self._robots[robot].t_ns = batch.t_ns
        lasted_ns = batch.t_ns - self._rated_ns
        if lasted_ns >= RATE_WINDOW_NS:
            self._rated_ns = batch.t_ns
            for heard in self._robots.values():
                heard.per_s, heard.count = heard.count * NS_PER_S / lasted_ns, 0

    def _note(self, sender: str, event: pb.Event) -> None:
        self._recent.append(
            pb.RecentEvent(
                t_ns=self._t_ns, sender=sender, level=event.level, name=event.name, text=event.text
            )
        )


def is_own(topic: Topic[Any]) -> bool:
    """Whether a robot itself sends a topic: neither what it is sent nor what is told about it."""
    return topic.pattern.startswith("robot/") and not topic.to_robot
