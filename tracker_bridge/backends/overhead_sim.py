"""A camera above a simulated run: its pictures are rendered from the truth, and looked at like real ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from swarm.clock import NS_PER_S
from swarm.config.experiment import ArenaSettings
from swarm.errors import UserError
from swarm.learning.random import spawned_generator
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.subscription import Received
from tracker_bridge.backends.interface import Backend, Setup, TrackingSystem
from tracker_bridge.backends.overhead import Camera, OverheadTracker
from tracker_bridge.emulators.camera.floor import plain_floor
from tracker_bridge.emulators.camera.optics import Optics, Station
from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.emulators.camera.scene import Faults, Swarm, TagPlate
from tracker_bridge.emulators.camera.true_view import true_view
from tracker_bridge.overhead.frames import Frame
from tracker_bridge.overhead.settings import RobotTag
from tracker_bridge.overhead.tag_tracking import TagTracker
from tracker_bridge.overhead.tags import TagDetector, TagFamily

Floats = npt.NDArray[np.float64]

FAMILY = "36h11"
MARGIN_M = 0.15
"""Of the floor beyond the arena that the camera sees."""


class RenderedTruth:
    """Pictures of the robots where they truly are, `rate_hz` a second; `truths` gives what has arrived."""

    def __init__(
        self,
        camera: CameraRenderer,
        robots: list[str],
        rate_hz: float,
        truths: Callable[[], Iterable[Received[pb.Truth]]],
    ) -> None:
        self._camera, self._robots, self._truths = camera, robots, truths
        self._period_ns = round(NS_PER_S / rate_hz)
        self._due_ns = 0
        self._poses: dict[str, list[float]] = {}

    def frames(self, t_ns: int) -> list[Frame]:  # noqa: ARG002
        captured_t_ns = -1
        for received in self._truths():
            truth, captured_t_ns = received.message, received.header.t_ns
            self._poses[received.robot] = [truth.x_m, truth.y_m, truth.theta_rad]
        if captured_t_ns < self._due_ns:
            return []
        self._due_ns += self._period_ns * (1 + (captured_t_ns - self._due_ns) // self._period_ns)
        return [Frame(self._camera.render(self._swarm()), captured_t_ns)]

    def close(self) -> None:
        """There is nothing to let go."""

    def _swarm(self) -> Swarm:
        there = [number for number, robot in enumerate(self._robots) if robot in self._poses]
        poses = np.array([self._poses[self._robots[number]] for number in there])
        return Swarm(tuple(there), poses, np.zeros_like(poses))


def camera_over(arena: ArenaSettings, robots: int, rng: np.random.Generator) -> CameraRenderer:
    """A camera above the arena's middle whose picture holds the arena and no more."""
    usual, plate = Optics(), TagPlate()
    station = Station(arena.width_m / 2, arena.height_m / 2)
    px_per_m = usual.focal_px / (station.height_m - plate.height_m)
    width, height = (round(px_per_m * (side + 2 * MARGIN_M)) for side in (arena.width_m, arena.height_m))
    optics = replace(usual, width=width, height=height, centre_u=width / 2, centre_v=height / 2)
    family = TagFamily(FAMILY)
    codes = {tag: family.code(tag) for tag in range(robots)}
    return CameraRenderer(optics, station, plate, Faults(), codes, plain_floor(optics, rng), rng)


@contextmanager
def _opened(setup: Setup) -> Iterator[Backend]:
    experiment = setup.experiment
    if setup.node is None:
        raise UserError('[tracker] backend is "overhead-sim", which sees robots only within a run')
    robots = [robot.id for robot in experiment.robot]
    rng = spawned_generator(experiment.run.seed, "", setup.trial, robot="", component="overhead camera")
    camera = camera_over(experiment.arena, len(robots), rng)
    truths = setup.node.subscribe(topics.TRUTH)
    source = RenderedTruth(camera, robots, experiment.tracker.rate_hz, truths.take)
    tracker = TagTracker(TagDetector(TagFamily(FAMILY, range(len(robots)))))
    tags = {number: RobotTag(number, robot) for number, robot in enumerate(robots)}
    seen = Camera(source, true_view(camera), tracker)
    yield OverheadTracker([seen], tags, camera.plate.side_m, camera.plate.height_m)


SYSTEM = TrackingSystem(_opened, poll_s=None)
