"""The tracker backends by the name that an experiment file gives them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from swarm.config.experiment import Experiment
from swarm.errors import UserError, nearest
from swarm.learning.random import spawned_generator
from swarm.messages import topics
from swarm.runtime.node import Node
from tracker_bridge.backends.interface import Backend
from tracker_bridge.backends.sim import SimulatedTracker

MakeBackend = Callable[[Experiment, Node, int], Backend]


def _simulated(experiment: Experiment, node: Node, trial: int) -> Backend:
    truths = node.subscribe(topics.TRUTH)
    generator = partial(spawned_generator, experiment.run.seed, "", trial, component="tracker")
    return SimulatedTracker(experiment.tracker, truths.take, lambda robot: generator(robot=robot))


BACKENDS: dict[str, MakeBackend] = {"sim": _simulated}
"""[tracker] backend: a new tracking system adds one line."""


def backend_names() -> list[str]:
    """What an experiment file may call a tracking system."""
    return list(BACKENDS)


def backend_named(name: str) -> MakeBackend:
    if name not in BACKENDS:
        raise UserError(f"[tracker] backend is {name!r}; {nearest(name, BACKENDS)}")
    return BACKENDS[name]
