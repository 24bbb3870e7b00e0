"""The poses of a run's log, as they were published: already in the arena frame."""

from __future__ import annotations

from pathlib import Path

from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from tracker_bridge.backends.interface import TrackedPose

MAGIC = b"\x89MCAP"


def is_log(path: Path) -> bool:
    """Whether a file begins as an MCAP file does."""
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


def read_log(path: Path) -> list[TrackedPose]:
    """Every pose, in the order of capture; UserError if there is none, or the lab extra is missing."""
    require_extra("lab", "mcap")
    from swarm.logs.reader import LogReader

    reader = LogReader(path, lambda channel: channel.topic is topics.POSE)
    found = [
        _tracked(part.channel.publisher, pb.Pose.FromString(payload))
        for part in reader.parts()
        for payload in part.payloads
    ]
    if not found:
        raise UserError(f"{path}: there are no poses in this log")
    return sorted(found, key=lambda tracked: tracked.captured_t_ns)


def _tracked(robot: str, pose: pb.Pose) -> TrackedPose:
    return TrackedPose(
        robot,
        Pose(pose.x_m, pose.y_m, pose.theta_rad),
        pose.captured_t_ns,
        source_t_ns=pose.source_t_ns,
        residual_m=pose.residual_m,
        quality=pose.quality,
    )
