"""What viewers draw without a plug-in: the arena, the robots and the events, in Foxglove's schemas.

These messages are made by the server for the log alone. They are not on the wire: a board needs neither
the schemas nor the time to fill them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.message import Message

from server.hubs.hub import Batch
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.geometry import Compartment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.runtime.subscription import Subscription, Subscriptions

FRAME = "arena"
ROBOTS_PERIOD_NS = NS_PER_S
"""Enough for the eye, and a small part of the log: the poses themselves are in it at their full rate."""
LINE_M = 0.01
"""Looks only: a line that can be seen beside cells of 0.12 m."""
LEVELS = {pb.Event.INFO: Log.INFO, pb.Event.WARNING: Log.WARNING, pb.Event.ERROR: Log.ERROR}
View = tuple[str, Message]


class Views:
    """Makes the messages for viewers out of the batches: the arena once, the robots once a second."""

    def __init__(self, experiment: Experiment) -> None:
        self._experiment = experiment
        self._poses = Subscription(topics.POSE)
        events = (topics.EVENT, topics.TRACKER_EVENT, topics.SERVER_EVENT)
        self._events: dict[Topic[Any], Subscription[pb.Event]] = {
            topic: Subscription(topic) for topic in events
        }
        self._subscriptions = Subscriptions((self._poses, *self._events.values()))
        self._latest: dict[str, pb.Pose] = {}
        self._due_ns: int | None = None

    def of(self, batch: Batch) -> Iterator[View]:
        """Topic and message of every view that the batch calls for."""
        self._subscriptions.put(batch.items)
        if self._due_ns is None:
            yield topics.VIEW_ARENA, self._arena(batch.t_ns)
        if self._due_ns is None or batch.t_ns >= self._due_ns:
            self._due_ns = batch.t_ns + ROBOTS_PERIOD_NS
            yield topics.VIEW_ROBOTS, self._robots(batch.t_ns)
        for topic, events in self._events.items():
            for received in events.take():
                yield (
                    topics.VIEW_LOG,
                    _log_line(received.robot or topic.pattern, received.message, batch.t_ns),
                )

    def _robots(self, t_ns: int) -> PosesInFrame:
        for received in self._poses.take():
            self._latest[received.robot] = received.message
        view = PosesInFrame(frame_id=FRAME)
        view.timestamp.FromNanoseconds(t_ns)
        for _, pose in sorted(self._latest.items()):
            drawn = view.poses.add()
            drawn.position.x, drawn.position.y = pose.x_m, pose.y_m
            drawn.orientation.z, drawn.orientation.w = _half_turn(pose.theta_rad)
        return view

    def _arena(self, t_ns: int) -> SceneUpdate:
        view = SceneUpdate()
        for robot in self._experiment.robot:
            entity = view.entities.add(frame_id=FRAME, id=robot.id)
            entity.timestamp.FromNanoseconds(t_ns)
            line = entity.lines.add(thickness=LINE_M)
            line.type = line.LINE_LOOP
            line.color.r = line.color.g = line.color.b = 0.5
            line.color.a = line.pose.orientation.w = 1.0
            for x_m, y_m in _corners(self._experiment.compartment(robot)):
                line.points.add(x=x_m, y=y_m)
        return view


def _corners(compartment: Compartment) -> list[tuple[float, float]]:
    west_m, east_m = compartment.west_m, compartment.east_m
    south_m, north_m = compartment.south_m, compartment.north_m
    return [(west_m, south_m), (east_m, south_m), (east_m, north_m), (west_m, north_m)]


def _half_turn(theta_rad: float) -> tuple[float, float]:
    """z and w of the quaternion of a heading."""
    return math.sin(theta_rad / 2), math.cos(theta_rad / 2)


def _log_line(name: str, event: pb.Event, t_ns: int) -> Log:
    line = Log(level=LEVELS.get(event.level, Log.INFO), name=name, message=f"{event.name}: {event.text}")
    line.timestamp.FromNanoseconds(t_ns)
    return line
