"""What a tracking system has shown for a while: whom, how often, how late, how well; what is wrong."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.geometry import Pose
from tracker_bridge.backends.datagrams import Arrivals
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.mistakes import likely_mistakes
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

NS_PER_MS = 1_000_000
THINNED_NS = NS_PER_S // 20
"""Mistakes of units and axes show in 20 poses a second as well as in 300."""
MOST_STRANGERS = 100
"""Whoever invents names may not fill the memory."""


@dataclass(frozen=True)
class RobotReport:
    """One robot, by its last pose. The latency is from the packet's receipt to where a pose is published."""

    robot: str
    poses: int
    rate_hz: float
    x_m: float
    y_m: float
    theta_rad: float
    latency_p50_ms: float
    latency_p99_ms: float
    longest_gap_ms: float
    residual_mm: float
    quality: float
    refused: dict[str, int]
    """Poses that the plausibility gate would not have passed on, by kind of reason."""


@dataclass(frozen=True)
class Report:
    """Everything that `tracker-bridge check` says."""

    backend: str
    seconds: float
    senders: dict[str, int]
    refused: dict[str, int]
    """Datagrams by the reason for which they were refused."""
    robots: list[RobotReport]
    missing: list[str]
    strangers: dict[str, int]
    """Bodies that are no robot of the experiment, and how often they were seen."""
    mistakes: list[str]


@dataclass
class _Seen:
    poses: list[TrackedPose] = field(default_factory=list)
    latencies_ns: list[int] = field(default_factory=list)
    refused: Counter[str] = field(default_factory=Counter)


class Survey:
    """Takes in poses until it is asked for a report."""

    def __init__(self, experiment: Experiment) -> None:
        self._experiment = experiment
        arena = experiment.arena
        self._plausibility = Plausibility(PlausibilitySettings(arena.width_m, arena.height_m))
        self._robots = {robot.id: _Seen() for robot in experiment.robot}
        self._strangers: Counter[str] = Counter()
        self._kept: list[TrackedPose] = []
        self._kept_ns: dict[str, int] = {}

    def take(self, poses: list[TrackedPose], now_ns: int) -> None:
        """Poses that could be published now."""
        for tracked in poses:
            seen = self._robots.get(tracked.robot)
            if seen is None:
                self._count_stranger(tracked.robot)
                continue
            self._keep(tracked)
            seen.poses.append(tracked)
            seen.latencies_ns.append(now_ns - tracked.received_t_ns)
            reason = self._plausibility.reason_against(tracked)
            if reason:
                seen.refused[reason.split(" ")[0].rstrip(":")] += 1

    def report(self, seconds: float, arrivals: Arrivals) -> Report:
        """What was seen within so many seconds."""
        arena = self._experiment.arena
        return Report(
            self._experiment.tracker.backend,
            round(seconds, 3),
            dict(arrivals.senders),
            dict(arrivals.refused),
            [_report(robot, seen, seconds) for robot, seen in self._robots.items() if seen.poses],
            [robot for robot, seen in self._robots.items() if not seen.poses],
            dict(self._strangers),
            likely_mistakes(self._kept, arena.width_m, arena.height_m) + sorted(arrivals.hints),
        )

    @property
    def tracks(self) -> dict[str, list[Pose]]:
        """Some of each robot's poses, in order."""
        tracks: dict[str, list[Pose]] = {}
        for tracked in self._kept:
            tracks.setdefault(tracked.robot, []).append(tracked.pose)
        return tracks

    def _count_stranger(self, name: str) -> None:
        known = name in self._strangers or len(self._strangers) < MOST_STRANGERS
        self._strangers[name if known else "others"] += 1

    def _keep(self, tracked: TrackedPose) -> None:
        """Some of the poses, to look for mistakes in."""
        due_ns = self._kept_ns.get(tracked.robot, tracked.captured_t_ns)
        if tracked.captured_t_ns >= due_ns:
            self._kept.append(tracked)
            self._kept_ns[tracked.robot] = tracked.captured_t_ns + THINNED_NS


def _report(robot: str, seen: _Seen, seconds: float) -> RobotReport:
    last = seen.poses[-1]
    times_ns = [tracked.captured_t_ns for tracked in seen.poses]
    gaps_ns = [later - earlier for earlier, later in pairwise(times_ns)]
    latencies_ms = sorted(latency_ns / NS_PER_MS for latency_ns in seen.latencies_ns)
    return RobotReport(
        robot,
        len(seen.poses),
        round(len(seen.poses) / seconds, 2),
        round(last.pose.x_m, 4),
        round(last.pose.y_m, 4),
        round(last.pose.theta_rad, 4),
        round(latencies_ms[len(latencies_ms) // 2], 3),
        round(latencies_ms[99 * len(latencies_ms) // 100], 3),
        round(max(gaps_ns, default=0) / NS_PER_MS, 1),
        round(1000 * last.residual_m, 3),
        round(last.quality, 2),
        dict(seen.refused),
    )


def table(report: Report) -> str:
    """The report for a person."""
    lines = [f"{report.backend}, {report.seconds:g} s"]
    lines += [f"  from {sender:<22}{count:>8} datagrams" for sender, count in report.senders.items()]
    lines += [f"  refused {count:>8}: {reason}" for reason, count in report.refused.items()]
    lines.append(_HEAD)
    lines += [_row(robot) for robot in report.robots]
    lines += [f"{robot:<16}  not seen" for robot in report.missing]
    lines += [f"{name:<16}  no robot here, seen {n} times" for name, n in report.strangers.items()]
    return "\n".join(lines + [f"likely mistake: {mistake}" for mistake in report.mistakes])


_HEAD = (
    f"{'robot':<16}{'rate Hz':>8}{'x m':>9}{'y m':>9}{'heading':>9}{'latency ms p50':>16}{'p99':>8}"
    f"{'gap ms':>8}{'resid mm':>9}{'seen':>6}  refused"
)


def _row(robot: RobotReport) -> str:
    refused = ", ".join(f"{kind} {count}" for kind, count in robot.refused.items())
    return (
        f"{robot.robot:<16}{robot.rate_hz:>8.1f}{robot.x_m:>9.3f}{robot.y_m:>9.3f}{robot.theta_rad:>9.2f}"
        f"{robot.latency_p50_ms:>16.2f}{robot.latency_p99_ms:>8.2f}{robot.longest_gap_ms:>8.1f}"
        f"{robot.residual_mm:>9.2f}{robot.quality:>6.2f}  {refused}"
    )
