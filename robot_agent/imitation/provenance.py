"""The ledger: every copied path carries its provenance, frame by frame, into the log."""

from __future__ import annotations

from collections.abc import Sequence

from robot_agent.imitation.copying import Copy, NoCopy
from robot_agent.imitation.observer import Looked, Watch
from robot_agent.vision.detector import NotSeen
from swarm.messages import swarm_pb2 as pb


def observation_message(
    visit: int, profile: str, watch: Watch, copied: Copy | NoCopy, window: Sequence[int]
) -> pb.Observation:
    """Frames, sightings, smoothed positions, segments and moves of one visit; or why there are none."""
    message = pb.Observation(
        visit=visit,
        profile=profile,
        frames=watch.expected_frames,
        looks=[_look(looked) for looked in watch.looks],
    )
    if isinstance(copied, NoCopy):
        message.reason = copied.reason
        return message
    for position in copied.smoothed:
        message.smoothed.add(captured_t_ns=position.t_ns, x_m=position.x_m, y_m=position.y_m)
    for segment in copied.segments:
        message.segments.add(
            turn_rad=segment.turn_rad,
            length_m=segment.length_m,
            heading_rad=segment.heading_rad,
            began_t_ns=segment.t_start_ns,
            ended_t_ns=segment.t_end_ns,
        )
    message.moves.extend(int(moved.move) for moved in copied.moves)
    message.confidences.extend(moved.confidence for moved in copied.moves)
    message.window.extend(window)
    return message


def _look(looked: Looked) -> pb.Look:
    look = pb.Look(captured_t_ns=looked.t_ns, frame_hash=looked.frame_hash)
    if isinstance(looked.answer, NotSeen):
        look.not_seen = looked.answer.reason.value
        return look
    look.range_m, look.bearing_rad = looked.answer.range_m, looked.answer.bearing_rad
    if looked.position:
        look.x_m, look.y_m = looked.position.x_m, looked.position.y_m
    return look
