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
GREY = (128, 128, 128)
NS_PER_S = 1e9


class Shown:
    """What Rerun is told of each message, by the last part of its topic."""

    def __init__(self) -> None:
        self._places: dict[str, list[tuple[float, float]]] = {}
        """Of each robot, since it began its journey from start to goal."""
        self._journeys: dict[str, int] = {}
        self.of: dict[str, Callable[[str, Any], None]] = {
            "arena": self.arena,
            "pose": self.pose,
            "move": self.move,
            "best_path": self.best_path,
            "log": self.log,
        }

    def arena(self, _: str, scene: Any) -> None:
        """The borders of the compartments; Rerun's y points down, the arena's up."""
        borders = [[(point.x, -point.y) for point in entity.lines[0].points] for entity in scene.entities]
        closed = [[*border, border[0]] for border in borders]
        rr.log("arena/borders", rr.LineStrips2D(closed, colors=[GREY] * len(closed)))

    def pose(self, robot: str, pose: Any) -> None:
        """Where the tracker saw it."""
        place = (pose.x_m, -pose.y_m)
        self._places.setdefault(robot, []).append(place)
        rr.log(f"arena/robots/{robot}", rr.Points2D([place], radii=ROBOT_RADIUS_M, labels=robot))

    def move(self, robot: str, move: Any) -> None:
        """How it came here on this journey, and what it learnt."""
        places = self._places.setdefault(robot, [])
        if self._journeys.get(robot, move.track) != move.track:
            del places[:-1]
        self._journeys[robot] = move.track
        rr.log(f"arena/paths/{robot}", rr.LineStrips2D([places]))
        rr.log(f"curves/q_change/{robot}", rr.Scalars(abs(move.q_change)))

    def best_path(self, robot: str, best: Any) -> None:
        """The learning curve: moves of the best path that it knows."""
        rr.log(f"curves/best_path/{robot}", rr.Scalars(best.length))

    def log(self, _: str, line: Any) -> None:
        """Every event."""
        rr.log(f"events/{line.name}", rr.TextLog(line.message))


def show(log: Path) -> None:
    """Tell Rerun a log from its first to its last message."""
    shown = Shown()
    with log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, record, message in reader.iter_decoded_messages():
            *_, robot, kind = channel.topic.split("/")
            if kind in shown.of:
                rr.set_time("run", duration=record.log_time / NS_PER_S)
                shown.of[kind](robot, message)


def blueprint() -> rrb.Blueprint:
    """The arena, and beside it the curves and the events."""
    best_path = rrb.TimeSeriesView(origin="curves/best_path", name="Best path, moves")
    q_change = rrb.TimeSeriesView(origin="curves/q_change", name="Change of Q")
    arena = rrb.Spatial2DView(origin="arena", name="Arena, m")
    events = rrb.TextLogView(origin="events", name="Events")
    return rrb.Blueprint(rrb.Horizontal(arena, rrb.Vertical(best_path, q_change, events)))


def main() -> None:
    """Open the viewer, or write what it would open."""
    parser = argparse.ArgumentParser(description="Shows a log in Rerun.")
    parser.add_argument("log", type=Path, metavar="LOG.mcap")
    parser.add_argument("--save", type=Path, metavar="FILE.rrd", help="write a file; no viewer opens")
    asked = parser.parse_args()
    rr.init(f"swarm {asked.log.stem}", spawn=asked.save is None)
    if asked.save:
        rr.save(asked.save)
    rr.send_blueprint(blueprint())
    show(asked.log)


if __name__ == "__main__":
    main()
