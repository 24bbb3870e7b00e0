"""How long a console takes: `python -m tests.benchmarks.console [--robots 3] [--moves 15000] [--keep LOG]`.

The log has the moves of real learners on drawn durations, and a pose of each robot ten times a second, as a
trial of so many moves has; the arena's other messages, which a console passes over, are left out.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from server.hubs.hub import Batch
from server.recording.recorder import Recorder
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, RobotSettings
from swarm.console.moment import frame
from swarm.console.run_history import RunHistory
from swarm.console.sources import LogSource
from swarm.console.viewer import Viewer
from swarm.geometry import Move
from swarm.learning.learner import Transition
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from tests.support.small_logs import metadata
from tests.support.swarm_runs import experiment_text, learners

TICK_S = 0.1
BATCHES_BETWEEN_FLUSHES = 1000
JUMPS = 200
"""Moves that are gone to, evenly over the log in a random order."""

Said = tuple[str, object]


class DrawnRobot:
    """A learner that glides from cell to cell, as long as a drawn duration."""

    def __init__(self, experiment: Experiment, settings: RobotSettings, number: int) -> None:
        self._name = settings.id
        self._room = experiment.compartment(settings)
        self._learner = experiment.learner(settings, 0)
        for path in settings.given_paths():
            self._learner.remember(path)
        self._durations = np.random.default_rng(number)
        self._state = self._room.grid.start

    def ticks(self, moves: int) -> Iterator[list[tuple[str, pb.Pose | pb.Move | pb.BestPath]]]:
        """What it says at every tick."""
        for _ in range(moves):
            action = Move(self._learner.choose(self._state).action)
            entered = self._room.grid.neighbour(self._state, action)
            ticks = 5 if entered is None else max(1, round(float(self._durations.normal(2.4, 0.2)) / TICK_S))
            arrived = self._state if entered is None else entered
            for tick in range(1, ticks + 1):
                yield [
                    ("pose", self._pose(arrived, action, tick / ticks)),
                    *(self._made(action, arrived, ticks) if tick == ticks else []),
                ]
            self._state = self._room.grid.start if arrived == self._room.grid.goal else arrived

    def _pose(self, arrived: int, action: Move, share: float) -> pb.Pose:
        (from_x, from_y), (to_x, to_y) = self._room.centre(self._state), self._room.centre(arrived)
        return pb.Pose(
            x_m=from_x + share * (to_x - from_x),
            y_m=from_y + share * (to_y - from_y),
            theta_rad=action.theta_rad,
        )

    def _made(self, action: Move, arrived: int, ticks: int) -> Iterator[tuple[str, pb.Move | pb.BestPath]]:
        made = self._learner.learn(
            Transition(self._state, action, arrived, ticks * TICK_S, arrived == self._state)
        )
        yield (
            "move",
            pb.Move(
                number=made.number,
                track=made.track,
                state=self._state,
                action=action,
                next_state=arrived,
                reward=made.reward,
                duration_s=ticks * TICK_S,
                q_value=made.q_value,
                q_change=made.q_change,
                path=made.path,
            ),
        )
        if made.best_path_length is not None:
            yield "best_path", pb.BestPath(move=made.number, length=made.best_path_length, cap=100)


def write_log(path: Path, robots: int, moves: int) -> None:
    """A log of so many learners, until the first of them has made its moves."""
    text = experiment_text(learners(robots, given=True), moves)
    experiment = Experiment.of_log("benchmark", text, {})
    head = metadata(robots={robot.id: "learner given" for robot in experiment.robot})
    head["run"]["moves"] = str(moves)
    recorder = Recorder(path, {**head, "experiment": {"toml": text}})
    saying = [
        DrawnRobot(experiment, robot, number).ticks(moves) for number, robot in enumerate(experiment.robot)
    ]
    numbers: dict[str, int] = {}
    for tick, said in enumerate(zip(*saying, strict=False), 1):
        t_ns = round(tick * TICK_S * NS_PER_S)
        items = []
        for robot, words in zip(experiment.robot, said, strict=True):
            for name, message in words:
                key = f"robot/{robot.id}/{name}"
                numbers[key] = numbers.get(key, 0) + 1
                items.append(Item(key, Header(1, numbers[key], t_ns), message.SerializeToString()))
        recorder.write(Batch(t_ns, items))
        if tick % BATCHES_BETWEEN_FLUSHES == 0:
            recorder.flush()
    recorder.end("complete", "", None)
    recorder.close()


def jumps_s(history: RunHistory) -> list[float]:
    """How long it takes until a page has been told all of a move: frame, table, memory, as JSON."""
    viewer = Viewer(history, live=False)
    viewer.asked({"ask": "pause"})
    list(viewer.step(0.0))
    last = history.robots[viewer.selected].learning.last_number
    moves = np.random.default_rng(1).permutation(np.linspace(1, last, JUMPS, dtype=int))
    found = []
    for move in moves:
        began_s = time.perf_counter()
        viewer.asked({"ask": "move", "robot": viewer.selected, "number": int(move)})
        json.dumps(list(viewer.step(0.0)))
        found.append(time.perf_counter() - began_s)
    return found


def measure(log: Path) -> dict[str, float]:
    """Seconds to read a log, to go to a move of it, and to make a frame."""
    began_s = time.perf_counter()
    source = LogSource([log])
    while not source.is_read:
        source.poll()
    read_s = time.perf_counter() - began_s
    source.close()
    history = source.history
    jumps = jumps_s(history)
    began_s = time.perf_counter()
    for place in np.linspace(0, history.end_s, JUMPS):
        json.dumps(frame(history, place, place - 0.1))
    return {
        "messages": history.messages,
        "read_s": round(read_s, 2),
        "jump_median_s": round(float(np.median(jumps)), 4),
        "jump_longest_s": round(max(jumps), 4),
        "frame_s": round((time.perf_counter() - began_s) / JUMPS, 5),
    }


def main() -> None:
    """Make a log, or take the one that is kept, and print the figures as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=3)
    parser.add_argument("--moves", type=int, default=15_000)
    parser.add_argument("--keep", type=Path, help="where the log is, or is left")
    asked = parser.parse_args()
    with TemporaryDirectory() as directory:
        log = asked.keep or Path(directory) / "trial-000.mcap"
        if not log.exists():
            write_log(log, asked.robots, asked.moves)
        print(json.dumps(measure(log)))


if __name__ == "__main__":
    main()
