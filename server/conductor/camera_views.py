"""Simulation: shows each observer's camera what stands in the compartment that it watches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from server.reporter import Reporter
from swarm.config.experiment import Experiment
from swarm.geometry import Compartment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.subscription import Received

LEDGE_M = 0.02
"""A robot on its compartment's border is still in it; far less than a cell, so no neighbour is."""


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
            self._reporter.publish(topics.VIEW, self._view(observer, demonstrator), observer)

    def _view(self, observer: str, demonstrator: str) -> pb.View:
        room = self._experiment.compartment(self._experiment.robot_named(demonstrator))
        view = pb.View(t_ns=self._t_ns)
        view.walls.add(west_m=room.west_m, south_m=room.south_m, east_m=room.east_m, north_m=room.north_m)
        for robot in self._experiment.robot:
            truth = self._truths.get(robot.id)
            if truth and robot.id != observer and _is_in(room, truth):
                view.bodies.add(x_m=truth.x_m, y_m=truth.y_m, theta_rad=truth.theta_rad, skirt=robot.skirt)
        return view


def _is_in(room: Compartment, truth: pb.Truth) -> bool:
    return (
        room.west_m - LEDGE_M < truth.x_m < room.east_m + LEDGE_M
        and room.south_m - LEDGE_M < truth.y_m < room.north_m + LEDGE_M
    )
