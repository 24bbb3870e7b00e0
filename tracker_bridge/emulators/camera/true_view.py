"""The emulated camera as calibration would find it at best."""

from __future__ import annotations

from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.overhead.arena_view import ArenaView
from tracker_bridge.overhead.lens import Lens


def true_view(camera: CameraRenderer) -> ArenaView:
    """Its lens and its place, without error."""
    optics, rotation = camera.optics, camera.station.axes.T
    size, focal, centre = (optics.width, optics.height), optics.focal_px, (optics.centre_u, optics.centre_v)
    lens = Lens(*size, focal, focal, *centre, (optics.k1, optics.k2, optics.p1, optics.p2, 0.0))
    return ArenaView(lens, rotation, -rotation @ camera.station.place)
