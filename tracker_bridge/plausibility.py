"""The plausibility plausibility: what a tracking system says is not believed before it was looked at."""

from __future__ import annotations

import math
from collections import defaultdict, deque
from dataclasses import dataclass, field

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.mistakes import likely_mistake


@dataclass(frozen=True)
class PlausibilitySettings:
    """What a robot can do at most. An e-puck makes 0.13 m/s; a hand that carries it, far more."""

    width_m: float
    height_m: float
    margin_m: float = 0.25
    """Robots may be carried a little beyond the arena's edge."""
    fastest_m_per_s: float = 0.5
    slack_m: float = 0.02
    """Noise of two measurements."""
    window_ns: int = NS_PER_S // 2
    """Speed is looked at over so long: between two poses at 300 Hz the noise alone makes 0.6 m/s."""
    poses_to_believe: int = 5
    """So many poses that agree with each other prove that the robot really is elsewhere,"""
    believe_after_ns: int = 2 * NS_PER_S // 5
    """if they span so long: five poses at 10 Hz."""
    frozen_after: int = 30
    """So many poses equal to the last bit are a tracker that repeats itself."""
    same_place_m: float = 0.05
    """The centres of two e-pucks are at least 7 cm apart."""


@dataclass
class _Track:
    """A robot's past: what was believed lately, and what has been said since that was not."""

    believed: deque[TrackedPose] = field(default_factory=deque)
    doubted: deque[TrackedPose] = field(default_factory=deque)
    repeated: int = 0
    agreeing: int = 0
    swapped_with: str = ""


class Plausibility:
    """Judges one pose at a time, from each robot's own past and from where the others are."""

    def __init__(self, settings: PlausibilitySettings) -> None:
        self._settings = settings
        self._tracks: defaultdict[str, _Track] = defaultdict(_Track)

    def reason_against(self, tracked: TrackedPose) -> str | None:
        """Why a pose may not be passed on, or None if it may. The first word is the kind of reason."""
        track = self._tracks[tracked.robot]
        impossible = (
            self._not_finite(tracked.pose)
            or self._outside(tracked.pose)
            or self._late(track, tracked)
            or self._frozen(track, tracked)
        )
        if impossible:
            return impossible
        reachable = self._reachable(track.believed, tracked)
        return self._swapped(track, tracked, reachable) or self._jump(track, tracked, reachable)

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
        mistake = likely_mistake(pose, settings.width_m, settings.height_m)
        hint = f": {mistake}" if mistake else ""
        return f"outside the arena, at ({pose.x_m:g}, {pose.y_m:g}) m{hint}"

    @staticmethod
    def _late(track: _Track, tracked: TrackedPose) -> str | None:
        is_new = not track.believed or tracked.captured_t_ns > track.believed[-1].captured_t_ns
        return None if is_new else "older than the one before"

    def _frozen(self, track: _Track, tracked: TrackedPose) -> str | None:
        last = track.believed[-1] if track.believed else None
        track.repeated = track.repeated + 1 if last and last.pose == tracked.pose else 0
        if track.repeated < self._settings.frozen_after:
            return None
        return f"frozen: the same pose {track.repeated + 1} times"

    def _swapped(self, track: _Track, tracked: TrackedPose, reachable: bool) -> str | None:
        """A robot that jumps to where another just was is taken for it, until it jumps again."""
        if track.swapped_with and self._reachable(track.doubted, tracked):
            other = track.swapped_with
        else:
            track.doubted = deque() if track.swapped_with else track.doubted
            other = "" if reachable else self._robot_at(tracked)
        track.swapped_with = other
        if not other:
            return None
        self._add(track.doubted, tracked)
        return f"swapped with {other}? It jumped to where {other} was"

    def _robot_at(self, tracked: TrackedPose) -> str:
        """Another robot that was believed at that place a moment ago; "" if none was."""
        for robot, track in self._tracks.items():
            if robot == tracked.robot or not track.believed:
                continue
            last = track.believed[-1]
            is_recent = tracked.captured_t_ns - last.captured_t_ns <= self._settings.window_ns
            if is_recent and last.pose.distance_m(tracked.pose) <= self._settings.same_place_m:
                return robot
        return ""

    def _jump(self, track: _Track, tracked: TrackedPose, reachable: bool) -> str | None:
        """A jump is doubted until enough poses agree, for long enough, that the robot is there."""
        if reachable:
            self._believe(track, tracked)
            return None
        if not track.doubted or not self._reachable(track.doubted, tracked):
            track.doubted.clear()
            track.agreeing = 0
        self._add(track.doubted, tracked)
        track.agreeing += 1
        agreed_ns = tracked.captured_t_ns - track.doubted[0].captured_t_ns
        if track.agreeing >= self._settings.poses_to_believe and agreed_ns >= self._settings.believe_after_ns:
            track.believed, track.doubted = track.doubted, deque()
            return None
        return f"jump of {track.believed[-1].pose.distance_m(tracked.pose):.2f} m"

    def _believe(self, track: _Track, tracked: TrackedPose) -> None:
        track.doubted.clear()
        self._add(track.believed, tracked)

    def _add(self, poses: deque[TrackedPose], tracked: TrackedPose) -> None:
        """Keep what the window needs: the newest pose, and all that are not older than the window."""
        poses.append(tracked)
        while tracked.captured_t_ns - poses[0].captured_t_ns > self._settings.window_ns:
            poses.popleft()

    def _reachable(self, earlier: deque[TrackedPose], later: TrackedPose) -> bool:
        """Whether it could have driven there, from the last pose and from the first in the window."""
        return not earlier or (self._in_reach(earlier[-1], later) and self._in_reach(earlier[0], later))

    def _in_reach(self, earlier: TrackedPose, later: TrackedPose) -> bool:
        elapsed_s = (later.captured_t_ns - earlier.captured_t_ns) / NS_PER_S
        reach_m = self._settings.slack_m + self._settings.fastest_m_per_s * elapsed_s
        return earlier.pose.distance_m(later.pose) <= reach_m
