"""The frames of a simulated robot's visits, taken once more from its log.

A log has no pictures, but it has where every robot really was, and of the experiment's seed comes the noise.
Each frame's hash stands in the log: whether what is taken now is what the robot saw shows to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from robot_agent.drivers.sim.camera import BUILT_IN_MODEL, SimulatedRobotCamera
from robot_agent.vision.camera_model import CameraModel, load_calibration
from robot_agent.vision.detector import at_profile
from robot_agent.vision.frames import frame_hash
from robot_agent.vision.pixels import frame_pixels
from swarm.config.experiment import Experiment
from swarm.film.camera import CameraFrame, Truths
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.runtime.camera_view import camera_view
from swarm.runtime.subscription import Subscription


def retaken_frames(
    experiment: Experiment, robot: str, trial: int, truths: Truths, looks: Iterable[pb.Look]
) -> Iterator[CameraFrame]:
    """A frame for each look of a robot, in the order of all its looks of the trial, from the first on.

    Each frame takes of the camera's random numbers what the one before left. A look at a time of which the
    log has no truth gives none.
    """
    settings = experiment.robot_named(robot)
    views = Subscription(topics.VIEW)
    generator = experiment.generator(settings, trial, "camera")
    light = experiment.camera.conditions
    model, own = _model(experiment), _poses(truths[robot])
    camera = SimulatedRobotCamera(model, light, own, views, generator)
    for number, look in enumerate(looks, 1):
        t_ns = look.captured_t_ns
        there = {name: known[t_ns] for name, known in truths.items() if t_ns in known}
        if robot in there:
            view = camera_view(experiment, robot, settings.watches, there, t_ns)
            views.put(topics.VIEW.key(robot), Header(1, number, t_ns), view.SerializeToString())
            frame = camera.capture(t_ns)
            if frame is not None:
                yield CameraFrame(t_ns, frame_pixels(frame), frame_hash(frame), _column(model, look))


def _model(experiment: Experiment) -> CameraModel:
    """That of the robots of a run."""
    file = experiment.camera.calibration
    model = load_calibration(file).model() if file else BUILT_IN_MODEL
    return at_profile(experiment.visits.profile, model)


def _column(model: CameraModel, look: pb.Look) -> float | None:
    return None if look.not_seen else model.column(look.bearing_rad)


def _poses(truths: Mapping[int, pb.Truth]) -> Callable[[int], Pose]:
    def pose_at(t_ns: int) -> Pose:
        truth = truths[t_ns]
        return Pose(truth.x_m, truth.y_m, truth.theta_rad)

    return pose_at
