"""Shows a log in Rerun: where the robots are and were, the paths' lengths as they learn, and what was said.

    pip install rerun-sdk mcap mcap-protobuf-support
    python deploy/viewers/rerun_log.py runs/demo-001/trial-000.mcap              # opens Rerun's viewer
    python deploy/viewers/rerun_log.py runs/demo-001/trial-000.mcap --save demo.rrd

It needs nothing of the swarm runtime: a log says itself what its messages mean.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rerun as rr
import rerun.blueprint as rrb
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

ROBOT_RADIUS_M = 0.035
"""An e-puck's."""
NS_PER_S = 1e9


class Shown:
    """What Rerun is told of each message, by the last part of its topic."""

    def __init__(self) -> None:
        self._track: dict[str, list[tuple[float, float]]] = {}
        """Of each robot, the places of the track that it is on: from one start to the arrival."""
        self.of: dict[str, Callable[[str, Any], None]] = {
            "arena": self.arena,
            "pose": self.pose,
            "move": self.move,
            "best_path": self.best_path,
            "log": self.log,
        }

    def arena(self, _: str, scene: Any) -> None:
        """The borders of the compartments."""
        borders = [[(p.x, -p.y) for p in entity.lines[0].points] for entity in scene.entities]
        strips = rr.LineStrips2D([[*border, border[0]] for border in borders], colors=[128, 128, 128])
        rr.log("arena/borders", strips)

    def pose(self, robot: str, pose: Any) -> None:
        """Rerun's y points down, the arena's up."""
        place = (pose.x_m, -pose.y_m)
        track = self._track.setdefault(robot, [])
        track.append(place)
        rr.log(f"arena/{robot}", rr.Points2D([place], radii=ROBOT_RADIUS_M, labels=robot))
        rr.log(f"arena/{robot}/track", rr.LineStrips2D([track]))

    def move(self, robot: str, move: Any) -> None:
        """The first move of a track begins a new line."""
        track = self._track.get(robot, [])
        if move.track != self._number.get(robot):
            del track[:-1]
        self._number[robot] = move.track
        rr.log(f"curve/q_change/{robot}", rr.Scalars(abs(move.q_change)))

    def best_path(self, robot: str, best: Any) -> None:
        """The learning curve: moves of the best path that the robot knows."""
        rr.log(f"curve/best_path/{robot}", rr.Scalars(best.length))

    def log(self, _: str, line: Any) -> None:
        """Every event."""
        rr.log(f"events/{line.name}", rr.TextLog(line.message))
