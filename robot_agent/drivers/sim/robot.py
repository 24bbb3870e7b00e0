"""The `sim` driver: a simulated e-puck that shows the simulated tracker where it really is.

It is a body like any other: the agent cannot tell. A hand that carries a real robot is a `carry`
message here.
"""

from __future__ import annotations

from collections import deque

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.interfaces import Camera, DriverParts
from robot_agent.drivers.kinematics import WheelSpeeds, WheelSteps
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.vision.camera_model import CameraModel
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.node import Node

TICKS_REMEMBERED = 64
"""What a camera shows comes three exchanges late at most, of at most ten ticks each."""


class SimulatedRobot:
    """A simulated body that publishes its truth whenever its wheels are read: once a tick."""

    def __init__(self, body: SimulatedBody, node: Node, robot: str) -> None:
        self.body = body
        self._node = node
        self._robot = robot
        self._carries = node.subscribe(topics.CARRY, robot)
        self._truths: deque[tuple[int, Pose]] = deque(maxlen=TICKS_REMEMBERED)

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        return self.body.drive(speeds, t_ns)

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        steps = self.body.wheel_steps(t_ns)
        for carry in self._carries.take():
            to = carry.message
            self.body.place(Pose(to.x_m, to.y_m, to.theta_rad))
        truth = self.body.truth(t_ns)
        self._truths.append((t_ns, truth))
        self._node.publish(
            topics.TRUTH,
            pb.Truth(
                x_m=truth.x_m, y_m=truth.y_m, theta_rad=truth.theta_rad, wall_contacts=self.body.contacts
            ),
            self._robot,
        )
        return steps

    def truth_at(self, t_ns: int) -> Pose:
        """Where the robot really was at one of the last ticks; IndexError before the first."""
        return next((pose for tick_ns, pose in reversed(self._truths) if tick_ns <= t_ns), self._truths[0][1])

    def close(self) -> None:
        self.body.close()


class SimulatedDriver:
    """A simulated robot in its compartment, at the start."""

    def __init__(self, parts: DriverParts) -> None:
        faults = parts.experiment.body
        compartment = parts.experiment.compartment(parts.robot)
        self._parts = parts
        body = SimulatedBody(
            parts.geometry,
            BodyFaults(faults.slip_sd, faults.gain_error_sd, faults.latency_s),
            Pose(*compartment.centre(compartment.grid.start), 0.0),
            compartment,
            parts.generator("body"),
            obeys_for_s=STOP_WITHIN_S,
        )
        self.body = SimulatedRobot(body, parts.node, parts.robot.id)

    def camera(self, model: CameraModel) -> Camera:
        """A rendered camera; what it takes to render is loaded here and not before."""
        from robot_agent.drivers.sim.camera import SimulatedRobotCamera

        parts = self._parts
        light = parts.experiment.camera.conditions
        generator = parts.generator("camera")
        views = parts.node.subscribe(topics.VIEW, parts.robot.id)
        return SimulatedRobotCamera(model, light, self.body.truth_at, views, generator)
