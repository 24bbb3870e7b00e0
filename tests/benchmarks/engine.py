"""How fast the compiled engine learns, against a plain C loop and a Gymnasium agent, on one core.

    python -m tests.benchmarks.engine [--steps 4000000] [--rounds 5]

All learn the 100 x 100 arena at epsilon 0.5 from empty tables. Contestants take turns, thread-CPU time
is measured, and the medians of each round's ratios are printed as one line of JSON.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import random
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from swarm.geometry import MOVES, Move
from swarm.gridworld.arena import OBSTACLE_100, neighbours
from swarm.gridworld.condition import Condition, GivenPaths, NoTeacher, Teacher
from swarm.gridworld.simulation import simulate
from swarm.learning.memory import ObservedPath
from swarm.learning.q_table import ALPHA, GAMMA

EPSILON, BETA, PATH_MOVES = 0.5, 0.5, 20
EIGHT_PATHS = GivenPaths(tuple(ObservedPath((move,) * PATH_MOVES) for move in Move))
GYM_SHARE = 20
"""The Gymnasium agent takes this many times fewer steps."""


class GridWorld(gymnasium.Env[Any, Any]):
    """The arena as a Gymnasium environment over a neighbour table."""

    def __init__(self) -> None:
        grid = OBSTACLE_100.grid
        self.observation_space = gymnasium.spaces.Discrete(grid.states)
        self.action_space = gymnasium.spaces.Discrete(MOVES)
        self.neighbours = neighbours(OBSTACLE_100).tolist()
        self.start, self.goal = grid.start, grid.goal
        self.state = self.start

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, Any]:
        super().reset(seed=seed, options=options)
        self.state = self.start
        return self.state, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        self.state = state = self.neighbours[self.state][action]
        if state == self.goal:
            return state, 1.0, True, False, {}
        return state, 0.0, False, False, {}


def gymnasium_seconds(steps: int, seed: int) -> float:
    """Tabular Q-learning in plain Python lists, which are several times as fast here as NumPy rows."""
    env = GridWorld()
    draw, choice = random.Random(seed).random, random.Random(seed + 1).choice
    q = [[0.0] * MOVES for _ in range(OBSTACLE_100.grid.states)]
    began = time.thread_time()
    state, _ = env.reset(seed=seed)
    step = env.step
    for _ in range(steps):
        row = q[state]
        if draw() < EPSILON:
            action = int(draw() * MOVES)
        else:
            best = max(row)
            if row.count(best) == 1:
                action = row.index(best)
            else:
                action = choice([each for each, value in enumerate(row) if value == best])
        entered, reward, terminated, _, _ = step(action)
        row[action] += ALPHA * (reward + GAMMA * max(q[entered]) - row[action])
        state = env.reset()[0] if terminated else entered
    return time.thread_time() - began


def engine_seconds(teacher: Teacher, steps: int, seed: int) -> float:
    """The whole call, with its tables made and one evaluation of the best path."""
    condition = Condition(
        "speed", OBSTACLE_100, teacher, EPSILON, beta=BETA, steps=steps, evaluate_every=steps
    )
    began = time.thread_time()
    simulate(condition, seed, 0)
    return time.thread_time() - began


class PlainC:
    """`engine.c`, compiled here and now."""

    def __init__(self, folder: Path) -> None:
        library = folder / "engine.so"
        source = Path(__file__).with_suffix(".c")
        flags = ["-O3", "-march=native", "-shared", "-fPIC"]
        subprocess.run(["cc", *flags, str(source), "-o", str(library)], check=True)
        self.library = ctypes.CDLL(str(library))
        self.neighbours = np.ascontiguousarray(neighbours(OBSTACLE_100))
        paths = [path.moves for path in EIGHT_PATHS.paths]
        self.moves = np.array(paths, np.int8)
        self.ratios = np.zeros(len(paths))

    def seconds(self, teacher: Teacher, steps: int, seed: int) -> float:
        began = time.thread_time()
        q = np.zeros((OBSTACLE_100.grid.states, MOVES))
        grid = OBSTACLE_100.grid
        world = [pointer(q), pointer(self.neighbours), grid.start, grid.goal, ctypes.c_double(EPSILON)]
        run = [ctypes.c_int64(steps), ctypes.c_uint64(seed)]
        if isinstance(teacher, NoTeacher):
            self.library.learn_alone(*world, *run)
        else:
            given = [ctypes.c_double(BETA), pointer(self.moves), *self.moves.shape, pointer(self.ratios)]
            self.library.learn_with_paths(*world, *given, *run)
        return time.thread_time() - began


def pointer(array: np.ndarray[Any, Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def measure(plain_c: PlainC, steps: int, rounds: int) -> dict[str, Any]:
    """Medians over the rounds, in each of which every contestant runs once with the same seed."""
    few = steps // GYM_SHARE
    contestants: dict[str, Callable[[int], float]] = {
        "engine": lambda seed: engine_seconds(NoTeacher(), steps, seed) / steps,
        "c": lambda seed: plain_c.seconds(NoTeacher(), steps, seed) / steps,
        "gymnasium": lambda seed: gymnasium_seconds(few, seed) / few,
        "engine_eight_paths": lambda seed: engine_seconds(EIGHT_PATHS, steps, seed) / steps,
        "c_eight_paths": lambda seed: plain_c.seconds(EIGHT_PATHS, steps, seed) / steps,
    }
    engine_seconds(EIGHT_PATHS, 1_000, 0)
    taken = [{name: run(seed) for name, run in contestants.items()} for seed in range(rounds)]

    def ratio(slow: str, fast: str) -> float:
        return round(statistics.median(times[slow] / times[fast] for times in taken), 2)

    return {
        "benchmark": "engine",
        "steps": steps,
        "rounds": rounds,
        "over_gymnasium": ratio("gymnasium", "engine"),
        "over_plain_c": ratio("c", "engine"),
        "eight_paths_over_plain_c": ratio("c_eight_paths", "engine_eight_paths"),
        "steps_per_s": {
            name: round(1 / statistics.median(times[name] for times in taken)) for name in contestants
        },
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--steps", type=int, default=4_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps(measure(PlainC(Path(folder)), arguments.steps, arguments.rounds)))


if __name__ == "__main__":
    main()
