"""How far from its cell's centre a robot of a run really stood at the end of each move."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap.reader import make_reader

from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import topic_of


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
    truths, moves = _records(log, robot)
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


def _records(log: Path, robot: str) -> tuple[list[tuple[int, pb.Truth]], list[tuple[int, pb.Move]]]:
    """Truths and driven moves of one robot, in order of time."""
    found: dict[str, list[tuple[int, pb.Truth | pb.Move]]] = {"truth": [], "move": []}
    with log.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            topic = topic_of(channel.topic)
            if topic and topic[1] == robot and topic[0] in (topics.TRUTH, topics.MOVE):
                kind = "truth" if topic[0] is topics.TRUTH else "move"
                found[kind].append((message.publish_time, topic[0].message.FromString(message.data)))
    truths = [(t_ns, truth) for t_ns, truth in found["truth"] if isinstance(truth, pb.Truth)]
    moves = [(t_ns, move) for t_ns, move in found["move"] if isinstance(move, pb.Move) and not move.blocked]
    return sorted(truths, key=lambda pair: pair[0]), sorted(moves, key=lambda pair: pair[0])
