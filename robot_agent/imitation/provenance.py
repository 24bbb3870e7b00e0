"""Provenance: every copied path carries its provenance, frame by frame, into the log."""

from __future__ import annotations

from collections.abc import Sequence

from robot_agent.imitation.copying import Copy, NoCopy
from robot_agent.imitation.observer import ObservedFrame, Watch
from robot_agent.vision.detector import NotSeen
from swarm.messages import swarm_pb2 as pb


def observation_message(
    visit: int, profile: str, watch: Watch, copied: Copy | NoCopy, window: Sequence[int]
) -> pb.Observation:
    """Frames, detections, smoothed positions, segments and moves of one visit; or why there are none."""
    message = pb.Observation(
        visit=visit,
        profile=profile,
        frames=watch.expected_frames,
        looks=[_look(observed) for observed in watch.looks],
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


def _look(observed: ObservedFrame) -> pb.Look:
    look = pb.Look(captured_t_ns=observed.t_ns, frame_hash=observed.frame_hash)
    if isinstance(observed.answer, NotSeen):
        look.not_seen = observed.answer.reason.value
        return look
    look.range_m, look.bearing_rad = observed.answer.range_m, observed.answer.bearing_rad
    if observed.position:
        look.x_m, look.y_m = observed.position.x_m, observed.position.y_m
    return look
