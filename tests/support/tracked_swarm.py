"""Experiments with a real tracking system, and a swarm that stands where the examiners want it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from swarm.config.experiment import Experiment
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose

LOOPBACK = "127.0.0.1"
PLACES = {"a": Pose(1.0, 0.5, math.pi / 2), "b": Pose(2.0, 1.5, math.pi)}


def tracked_experiment(
    directory: Path, tracker: str, robots: Sequence[str] = ("a", "b"), robot: str = ""
) -> Experiment:
    """An experiment of robots in a row; `tracker` is what its [tracker] table says, `robot` what each robot's."""
    lines = ["[run]", 'name = "tracked"', "[arena]", f"width_m = {max(3.0, 1.3 * len(robots)):.1f}"]
    lines += ["[tracker]", tracker]
    for number, name in enumerate(robots):
        lines += ["[[robot]]", f'id = "{name}"', f"south_west_m = [{1.3 * number:.1f}, 0.0]", robot]
    file = directory / "tracked.toml"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return Experiment.load(file)


def standing(t_ns: int) -> list[TrackedPose]:
    """The examiners' two robots."""
    return [TrackedPose(robot, pose, t_ns) for robot, pose in PLACES.items()]
