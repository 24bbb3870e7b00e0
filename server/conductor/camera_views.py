"""Simulation: shows each observer's camera what stands in the compartment that it watches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from server.reporter import Reporter
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.camera_view import camera_view
from swarm.runtime.subscription import Received


class CameraViews:
    """Relays light, not messages: an observer receives a view under its own key, never another's pose."""

    def __init__(self, experiment: Experiment, reporter: Reporter) -> None:
        self._experiment = experiment
        self._reporter = reporter
        self._truths: dict[str, pb.Truth] = {}
        self._t_ns = 0

    def step(self, truths: Iterable[Received[pb.Truth]], watching: Mapping[str, str]) -> None:
        """Take in where the robots are, and show it to the observers."""
        for received in truths:
            self._truths[received.robot] = received.message
            self._t_ns = received.header.t_ns
        for observer, demonstrator in watching.items():
            view = camera_view(self._experiment, observer, demonstrator, self._truths, self._t_ns)
            self._reporter.publish(topics.VIEW, view, observer)
