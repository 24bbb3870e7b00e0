"""A log as a bag of ROS 2: poses as geometry_msgs, and everything else as it is, as JSON text.

The `rosbags` package writes it; no installation of ROS is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from google.protobuf.json_format import MessageToJson
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from swarm.clock import NS_PER_S
from swarm.logs.reader import LogChannel, LogReader, Part
from swarm.messages import topics
from swarm.messages.validation import BadMessageError, decode

FRAME = "arena"
BAG_VERSION: Final = 9
"""Of the bag's format: what ROS 2 reads since Iron."""
ROS = get_typestore(Stores.ROS2_HUMBLE)
"""The messages used here have been the same in every release since."""
POSES = (topics.POSE, topics.TRUTH)


class Line(NamedTuple):
    """One message for the bag."""

    t_ns: int
    topic: str
    type_name: str
    data: bytes


def write_bag(logs: Sequence[Path], out: Path) -> list[Path]:
    """A bag in a new folder: each message under its key, at the time at which it was recorded.

    A part of the log at a time, so that memory stays small: a bag's index, not its order, tells the times.
    """
    readers = [LogReader(log, lambda channel: channel.topic is not None) for log in logs]
    parts = (part for reader in readers for part in reader.parts() if part.payloads)
    lines = (line for part in parts for line in _lines(part))
    with Writer(out, version=BAG_VERSION, storage_plugin=StoragePlugin.MCAP) as bag:
        connections: dict[str, Any] = {}
        for line in lines:
            if line.topic not in connections:
                connections[line.topic] = bag.add_connection(line.topic, line.type_name, typestore=ROS)
            bag.write(connections[line.topic], line.t_ns, line.data)
    return sorted(out.iterdir())


def ros_topic(key: str) -> str:
    """A key as a name that ROS allows."""
    return "/" + key.replace("-", "_")


def _lines(part: Part) -> list[Line]:
    """What can be decoded of a part."""
    type_name, converted = _conversion(part.channel)
    topic, found = ros_topic(part.channel.key), []
    assert part.channel.topic is not None
    for t_ns, payload in zip(part.receive_t_ns, part.payloads, strict=True):
        try:
            message = converted(decode(part.channel.topic.message, payload), int(t_ns))
        except BadMessageError:
            continue
        found.append(Line(int(t_ns), topic, type_name, bytes(ROS.serialize_cdr(message, type_name))))
    return found


def _conversion(channel: LogChannel) -> tuple[str, Callable[[Any, int], Any]]:
    """The type's name in ROS, and what makes such a message."""
    if channel.topic in POSES:
        return "geometry_msgs/msg/PoseStamped", _pose_stamped
    return "std_msgs/msg/String", _text


def _pose_stamped(pose: Any, t_ns: int) -> Any:
    """Stamped with the time of capture, if the message has one."""
    kinds = ROS.types
    stamp_ns = getattr(pose, "captured_t_ns", 0) or t_ns
    stamp = kinds["builtin_interfaces/msg/Time"](sec=stamp_ns // NS_PER_S, nanosec=stamp_ns % NS_PER_S)
    half_rad = pose.theta_rad / 2
    return kinds["geometry_msgs/msg/PoseStamped"](
        header=kinds["std_msgs/msg/Header"](stamp=stamp, frame_id=FRAME),
        pose=kinds["geometry_msgs/msg/Pose"](
            position=kinds["geometry_msgs/msg/Point"](x=pose.x_m, y=pose.y_m, z=0.0),
            orientation=kinds["geometry_msgs/msg/Quaternion"](
                x=0.0, y=0.0, z=math.sin(half_rad), w=math.cos(half_rad)
            ),
        ),
    )


def _text(message: Any, _: int) -> Any:
    text = MessageToJson(message, preserving_proto_field_name=True, indent=None)
    return ROS.types["std_msgs/msg/String"](data=text)
