"""OptiTrack without rigid bodies: robots by their hats, from the markers that Motive does not label."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from tracker_bridge.backends.bodies import arena_frame
from tracker_bridge.backends.interface import Backend, Setup, TrackedPose, TrackingSystem
from tracker_bridge.backends.natnet import UNIT_M, NatNetTracker
from tracker_bridge.hats.bodies import MOST_PINS
from tracker_bridge.hats.hat_file import load_hats
from tracker_bridge.hats.hat_tracking import HatTracker, TrackedHat
from tracker_bridge.hats.patterns import Hat
from tracker_bridge.protocols.natnet_frame import Frame


class NatNetHats(NatNetTracker):
    """A client of one server that names robots itself; hats have the robots' ids."""

    def __init__(self, experiment: Experiment, hats: list[Hat]) -> None:
        super().__init__(experiment)
        self._arena = arena_frame(experiment, UNIT_M)
        self._hats = HatTracker(hats, experiment.tracker.noise_m)
        self._events: list[tuple[str, str]] = []

    def told(self) -> list[tuple[str, str]]:
        """Hats that were lost, swapped, or lack a pin, since the last call."""
        events, self._events = self._events, []
        return events

    def _tracked(self, frame: Frame, received_ns: int) -> Iterator[TrackedPose]:
        source_ns, sent_ns = self._times_ns(frame)
        captured_ns = self._clock.captured_ns(source_ns, sent_ns, received_ns)
        places = [self._arena.point(marker) for marker in frame.other_markers_m]
        points = np.array([complex(x_m, y_m) for x_m, y_m, _ in places], dtype=np.complex128)
        hats, events = self._hats.update(points, captured_ns)
        self._events += [(event.kind, event.text) for event in events]
        return (_pose(hat, captured_ns, received_ns, source_ns) for hat in hats)


def _pose(hat: TrackedHat, captured_ns: int, received_ns: int, source_ns: int) -> TrackedPose:
    quality = hat.pins_seen / MOST_PINS
    return TrackedPose(hat.name, hat.pose, captured_ns, received_ns, source_ns, hat.residual_m, quality)


@contextmanager
def _opened(setup: Setup) -> Iterator[Backend]:
    file = setup.experiment.tracker.file
    if not file:
        raise UserError('[tracker] backend is "natnet-hats", but no file says what hats there are')
    with closing(NatNetHats(setup.experiment, load_hats(Path(file)))) as backend:
        yield backend


SYSTEM = TrackingSystem(_opened)
