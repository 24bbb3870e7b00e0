"""The pictures of a robot's camera: a log has but their hashes, a film has what can be made again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.plugins import FRAMES, plugins

Truths = Mapping[str, Mapping[int, pb.Truth]]
"""Robot -> where it really was at each tick, by the run's time in ns."""


@dataclass(frozen=True)
class CameraFrame:
    """One frame of a visit."""

    t_ns: int
    pixels: NDArray[np.uint8]
    """(rows, columns, red green blue)."""
    hash: int
    """As in a log's `Look.frame_hash`."""
    column: float | None
    """Of the pixels, where the demonstrator was seen; None if it was not."""


class Retaking(Protocol):
    """Makes a robot's frames once more, those of all its looks in a trial, in their order."""

    def __call__(
        self, experiment: Experiment, robot: str, trial: int, truths: Truths, looks: Iterable[pb.Look], /
    ) -> Iterator[CameraFrame]: ...


@dataclass(frozen=True)
class SeenFrames:
    """What a robot's camera saw between two times, by time, and how many of the frames are proven."""

    frames: Sequence[CameraFrame]
    looks: Mapping[int, pb.Look]
    same: int
    """Frames with the hash that the log has, to the last bit what the robot saw."""

    def at(self, t_ns: int) -> CameraFrame | None:
        """The newest by then."""
        before = [frame for frame in self.frames if frame.t_ns <= t_ns]
        return before[-1] if before else None


def seen_frames(
    experiment: Experiment,
    robot: str,
    trial: int,
    truths: Truths,
    looks: Sequence[pb.Look],
    span_ns: tuple[int, int],
) -> SeenFrames:
    """The frames of a span; none for a robot whose frames nobody can make again."""
    by_time = {look.captured_t_ns: look for look in looks}
    began_ns, ended_ns = span_ns
    retake = plugins(FRAMES).get(experiment.robot_named(robot).driver)
    if retake is None or not any(began_ns <= t_ns <= ended_ns for t_ns in by_time):
        return SeenFrames([], {}, 0)
    taking: Retaking = retake.load()
    wanted = [look for look in looks if look.captured_t_ns <= ended_ns]
    frames = [
        frame
        for frame in taking(experiment, robot, trial, truths, wanted)
        if began_ns <= frame.t_ns <= ended_ns
    ]
    same = sum(by_time[frame.t_ns].frame_hash == frame.hash for frame in frames)
    return SeenFrames(frames, by_time, same)
