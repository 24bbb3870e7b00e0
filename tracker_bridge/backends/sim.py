"""The simulated tracking system: the truth at a rate, with noise, lateness and losses."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial

import numpy as np

from swarm.clock import NS_PER_S
from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from swarm.geometry import Pose
from swarm.learning.random import spawned_generator
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.subscription import Received
from swarm.tracker_noise import measured
from tracker_bridge.backends.interface import Backend, Setup, TrackedPose, TrackingSystem

SECONDS_PER_HOUR = 3600.0
STACK = 256
"""Draws made at once: the cost of a call to numpy no longer counts."""


class _SimulatedView:
    """One robot in the view of the cameras: when it is measured next and until when it is lost."""

    def __init__(self, settings: TrackerSettings, rng: np.random.Generator) -> None:
        self._settings = settings
        self._rng = rng
        self._period_ns = round(NS_PER_S / settings.rate_hz)
        self._due_ns = 0
        self._lost_until_ns = 0
        self._draws: list[tuple[list[float], list[float]]] = []

    def measure(self, truth: pb.Truth, t_ns: int) -> Pose | None:
        """The noisy pose, or None between two frames and while the robot is lost."""
        if t_ns < self._due_ns:
            return None
        self._due_ns += self._period_ns * (1 + (t_ns - self._due_ns) // self._period_ns)
        settings = self._settings
        noise, (loss, blackout) = self._drawn()
        if blackout < settings.blackouts_per_hour / SECONDS_PER_HOUR / settings.rate_hz:
            self._lost_until_ns = t_ns + round(settings.blackout_s * NS_PER_S)
        if t_ns < self._lost_until_ns:
            return None
        return measured(Pose(truth.x_m, truth.y_m, truth.theta_rad), settings, noise, loss)

    def _drawn(self) -> tuple[list[float], list[float]]:
        """Noise of x, y and heading, and two uniform numbers; drawn in stacks: four times as fast."""
        if not self._draws:
            noise = self._rng.standard_normal((STACK, 3)).tolist()
            self._draws = list(zip(noise, self._rng.random((STACK, 2)).tolist(), strict=True))
        return self._draws.pop()


class SimulatedTracker:
    """Measures the simulated truth; `truths` gives what has arrived of it since the last call.

    Each robot has a random generator of its own (`generator` makes it), so that one robot's poses do
    not depend on the others.
    """

    def __init__(
        self,
        settings: TrackerSettings,
        truths: Callable[[], Iterable[Received[pb.Truth]]],
        generator: Callable[[str], np.random.Generator],
    ) -> None:
        self._settings = settings
        self._truths = truths
        self._generator = generator
        self._views: dict[str, _SimulatedView] = {}
        self._under_way: list[tuple[int, str, TrackedPose]] = []
        self._latency_ns = round(settings.latency_s * NS_PER_S)

    def poses(self, t_ns: int) -> list[TrackedPose]:
        for received in self._truths():
            captured_t_ns = received.header.t_ns
            pose = self._view(received.robot).measure(received.message, captured_t_ns)
            if pose:
                tracked = TrackedPose(received.robot, pose, captured_t_ns)
                heapq.heappush(self._under_way, (captured_t_ns, received.robot, tracked))
        ready = []
        while self._under_way and self._under_way[0][0] + self._latency_ns <= t_ns:
            ready.append(heapq.heappop(self._under_way)[2])
        return ready

    def _view(self, robot: str) -> _SimulatedView:
        if robot not in self._views:
            self._views[robot] = _SimulatedView(self._settings, self._generator(robot))
        return self._views[robot]


@contextmanager
def _opened(setup: Setup) -> Iterator[Backend]:
    if setup.node is None:
        raise UserError('[tracker] backend is "sim", which sees robots only within a run')
    truths = setup.node.subscribe(topics.TRUTH)
    seed = setup.experiment.run.seed
    generator = partial(spawned_generator, seed, "", setup.trial, component="tracker")
    yield SimulatedTracker(setup.experiment.tracker, truths.take, lambda robot: generator(robot=robot))


SYSTEM = TrackingSystem(_opened, poll_s=None)
