"""Simulation: what stands before the camera of a robot that watches another."""

from __future__ import annotations

from collections.abc import Mapping

from swarm.config.experiment import Experiment
from swarm.geometry import Compartment
from swarm.messages import swarm_pb2 as pb

LEDGE_M = 0.02
"""A robot on its compartment's border is still in it; far less than a cell, so no neighbour is."""


def camera_view(
    experiment: Experiment, observer: str, demonstrator: str, truths: Mapping[str, pb.Truth], t_ns: int
) -> pb.View:
    """The walls around the demonstrator, and who is inside them, by where the robots really were."""
    room = experiment.compartment(experiment.robot_named(demonstrator))
    view = pb.View(t_ns=t_ns)
    view.walls.add(west_m=room.west_m, south_m=room.south_m, east_m=room.east_m, north_m=room.north_m)
    for robot in experiment.robot:
        truth = truths.get(robot.id)
        if truth and robot.id != observer and _is_in(room, truth):
            view.bodies.add(x_m=truth.x_m, y_m=truth.y_m, theta_rad=truth.theta_rad, skirt=robot.skirt)
    return view


def _is_in(room: Compartment, truth: pb.Truth) -> bool:
    return (
        room.west_m - LEDGE_M < truth.x_m < room.east_m + LEDGE_M
        and room.south_m - LEDGE_M < truth.y_m < room.north_m + LEDGE_M
    )
