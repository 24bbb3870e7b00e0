"""How far from its cell's centre a robot of a run really stood at the end of each move."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from google.protobuf.message import Message
from mcap.reader import make_reader

from swarm.config.experiment import Experiment
from swarm.messages import topics
from swarm.messages.topics import Topic

M = TypeVar("M", bound=Message)


@dataclass(frozen=True)
class StopErrors:
    """What the moves of one robot showed."""

    moves: int
    mean_cm: float
    p99_cm: float
    worst_cm: float
    wall_contacts: int


def stop_errors(log: Path, experiment: Experiment, robot: str) -> StopErrors:
    """The errors of the driven moves, by the truth at the time of each move's end."""
    compartment = experiment.compartment(experiment.robot_named(robot))
    truths = records(log, robot, topics.TRUTH)
    moves = [(t_ns, move) for t_ns, move in records(log, robot, topics.MOVE) if not move.blocked]
    times = [t_ns for t_ns, _ in truths]
    errors_cm = []
    for t_ns, move in moves:
        _, truth = truths[max(0, bisect.bisect_right(times, t_ns) - 1)]
        x_m, y_m = compartment.centre(move.next_state)
        errors_cm.append(100.0 * math.hypot(truth.x_m - x_m, truth.y_m - y_m))
    return StopErrors(
        len(errors_cm),
        float(np.mean(errors_cm)),
        float(np.quantile(errors_cm, 0.99)),
        float(np.max(errors_cm)),
        truths[-1][1].wall_contacts,
    )


def records(log: Path, robot: str, topic: Topic[M]) -> list[tuple[int, M]]:
    """One robot's messages of a topic with the times at which they were sent, in order of time."""
    found = []
    with log.open("rb") as file:
        for _, _, message in make_reader(file).iter_messages(topics=[topic.key(robot)]):
            found.append((message.publish_time, topic.message.FromString(message.data)))
    return sorted(found, key=lambda pair: pair[0])
