"""The `sim` camera driver: what a robot's camera would see of what the simulation puts before it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Rectangle, Scene, SceneRobot
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import Frame
from swarm.clock import NS_PER_S
from swarm.geometry import Pose, wrap_angle_rad
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.subscription import Subscription

BUILT_IN_MODEL = CameraModel(320, 240, math.radians(53.0), radial=(-0.08, 0.01), gamma=2.2)
"""An e-puck's camera with a field of view mid-way between the published values."""

CALIBRATION_RANGES_M = (0.2, 0.25, 0.3, 0.4, 0.5)


class SimulatedRobotCamera:
    """A camera like any other: it renders from the simulated truth, which the agent never sees.

    A frame is of the time of the newest view, and comes a little later, as a real camera's does.
    `truth_at` tells where the robot itself was then.
    """

    def __init__(
        self,
        model: CameraModel,
        conditions_name: str,
        truth_at: Callable[[int], Pose],
        views: Subscription[pb.View],
        rng: np.random.Generator,
    ) -> None:
        self._camera = SimulatedCamera(model, conditions(conditions_name), rng)
        self._truth_at = truth_at
        self._views = views
        self._view: pb.View | None = None
        self._shown_ns = -1
        self._velocities: list[tuple[float, float]] = []
        self._own: tuple[int, float] | None = None

    def capture(self, t_ns: int) -> Frame | None:  # noqa: ARG002
        """The newest frame; None while the simulation shows nothing new."""
        for received in self._views.take():
            self._take_in(received.message)
        view = self._view
        if view is None or view.t_ns <= self._shown_ns:
            return None
        self._shown_ns = view.t_ns
        own = self._truth_at(view.t_ns)
        turn_rate_rad_s = self._turn_rate_rad_s(own, view.t_ns)
        return self._camera.render(view.t_ns, own, self._scene(view), turn_rate_rad_s)

    def _take_in(self, view: pb.View) -> None:
        """Two views give the velocities that blur the image."""
        before, self._view = self._view, view
        elapsed_s = (view.t_ns - before.t_ns) / NS_PER_S if before else 0.0
        if before is None or len(before.bodies) != len(view.bodies) or not 0 < elapsed_s < 1:
            self._velocities = [(0.0, 0.0)] * len(view.bodies)
            return
        self._velocities = [
            ((now.x_m - then.x_m) / elapsed_s, (now.y_m - then.y_m) / elapsed_s)
            for then, now in zip(before.bodies, view.bodies, strict=True)
        ]

    def _scene(self, view: pb.View) -> Scene:
        walls = tuple(Rectangle(wall.west_m, wall.south_m, wall.east_m, wall.north_m) for wall in view.walls)
        bodies = tuple(
            SceneRobot(Pose(body.x_m, body.y_m, body.theta_rad), body.skirt, velocity)
            for body, velocity in zip(view.bodies, self._velocities, strict=True)
        )
        return Scene(walls, bodies)

    def _turn_rate_rad_s(self, own: Pose, t_ns: int) -> float:
        before, self._own = self._own, (t_ns, own.theta_rad)
        if before is None or not 0 < t_ns - before[0] < NS_PER_S:
            return 0.0
        return wrap_angle_rad(own.theta_rad - before[1]) * NS_PER_S / (t_ns - before[0])


def calibration_frames_of(model: CameraModel, skirt: str, rng: np.random.Generator) -> list[Frame]:
    """A robot with the skirt straight ahead in good light, as `robot-agent calibrate` wants it."""
    camera = SimulatedCamera(model, conditions("realistic"), rng)
    return calibration_frames(camera, skirt, CALIBRATION_RANGES_M)
