"""The plausibility gate: what a tracking system says is not believed before it was looked at."""

from __future__ import annotations

import math
from dataclasses import dataclass

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose


@dataclass(frozen=True)
class GateSettings:
    """What a robot can do at most. An e-puck makes 0.13 m/s; a hand that carries it, far more."""

    width_m: float
    height_m: float
    margin_m: float = 0.25
    """Robots may be carried a little beyond the arena's edge."""
    fastest_m_per_s: float = 0.5
    slack_m: float = 0.02
    """Noise of two measurements."""
    poses_to_believe: int = 5
    """So many poses that agree with each other prove that the robot really is elsewhere."""
    frozen_after: int = 30
    """So many poses equal to the last bit are a tracker that repeats itself."""


@dataclass
class _Track:
    believed: TrackedPose | None = None
    doubted: TrackedPose | None = None
    agreeing: int = 0
    repeated: int = 0


class Gate:
    """Judges one pose at a time, from each robot's own past."""

    def __init__(self, settings: GateSettings) -> None:
        self._settings = settings
        self._tracks: dict[str, _Track] = {}

    def reason_against(self, tracked: TrackedPose) -> str | None:
        """Why a pose may not be passed on, or None if it may."""
        track = self._tracks.setdefault(tracked.robot, _Track())
        return (
            self._not_finite(tracked.pose)
            or self._outside(tracked.pose)
            or self._late(track, tracked)
            or self._frozen(track, tracked)
            or self._jump(track, tracked)
        )

    @staticmethod
    def _not_finite(pose: Pose) -> str | None:
        finite = math.isfinite(pose.x_m) and math.isfinite(pose.y_m) and math.isfinite(pose.theta_rad)
        return None if finite else "not a number"

    def _outside(self, pose: Pose) -> str | None:
        settings = self._settings
        if abs(pose.theta_rad) > math.tau:
            return f"heading {pose.theta_rad:g} rad: is it in degrees?"
        if (
            -settings.margin_m <= pose.x_m <= settings.width_m + settings.margin_m
            and -settings.margin_m <= pose.y_m <= settings.height_m + settings.margin_m
        ):
            return None
        largest_m = max(abs(pose.x_m), abs(pose.y_m))
        hint = ": is it in millimetres?" if largest_m > 10 * max(settings.width_m, settings.height_m) else ""
        return f"outside the arena, at ({pose.x_m:g}, {pose.y_m:g}) m{hint}"

    @staticmethod
    def _late(track: _Track, tracked: TrackedPose) -> str | None:
        last = track.believed
        is_new = last is None or tracked.captured_t_ns > last.captured_t_ns
        return None if is_new else "older than the one before"

    def _frozen(self, track: _Track, tracked: TrackedPose) -> str | None:
        last = track.believed
        track.repeated = track.repeated + 1 if last and last.pose == tracked.pose else 0
        if track.repeated < self._settings.frozen_after:
            return None
        return f"frozen: the same pose {track.repeated + 1} times"

    def _jump(self, track: _Track, tracked: TrackedPose) -> str | None:
        """A jump is doubted until enough poses agree that the robot is there."""
        if track.believed is None or self._reachable(track.believed, tracked):
            track.believed, track.doubted = tracked, None
            return None
        agrees = track.doubted is not None and self._reachable(track.doubted, tracked)
        track.agreeing = track.agreeing + 1 if agrees else 1
        track.doubted = tracked
        if track.agreeing >= self._settings.poses_to_believe:
            track.believed, track.doubted = tracked, None
            return None
        return f"jump of {track.believed.pose.distance_m(tracked.pose):.2f} m"

    def _reachable(self, earlier: TrackedPose, later: TrackedPose) -> bool:
        elapsed_s = (later.captured_t_ns - earlier.captured_t_ns) / NS_PER_S
        reach_m = self._settings.slack_m + self._settings.fastest_m_per_s * elapsed_s
        return earlier.pose.distance_m(later.pose) <= reach_m
