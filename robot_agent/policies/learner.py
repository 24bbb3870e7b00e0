"""The learning robot: algorithm 3 with eq. 7 on measured durations, and its reports."""

from __future__ import annotations

from typing import Any

import numpy as np

from robot_agent.policies.policy import Publish, Transition
from swarm.geometry import Grid
from swarm.learning.controller import Controller, EndedReplay, Replay
from swarm.learning.greedy_path import greedy_path_length
from swarm.learning.memory import ImitationMemory, ObservedPath, RememberedPath
from swarm.learning.q_table import discount_over
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics

MOVES_BETWEEN_EVALUATIONS = 10
REWARD_IN_GOAL = 1.0


class Learner:
    """A controller with a grid, counters and a voice.

    `evaluation_rng` breaks the ties of the greedy path, so that looking at the learning does not change it.
    """

    def __init__(
        self,
        grid: Grid,
        controller: Controller,
        evaluation_rng: np.random.Generator,
        publish: Publish,
        *,
        moves_to_make: int,
        path_length_cap: int,
        discount_rate_per_s: float,
    ) -> None:
        self.moves = 0
        self.tracks = 0
        self._grid = grid
        self._controller = controller
        self._evaluation_rng = evaluation_rng
        self._publish = publish
        self._moves_to_make = moves_to_make
        self._path_length_cap = path_length_cap
        self._discount_rate_per_s = discount_rate_per_s
        self._numbers: dict[int, int] = {}
        self._paths = 0

    @property
    def finished(self) -> bool:
        return self.moves >= self._moves_to_make

    def remember(self, path: ObservedPath, source: str, visit: int = 0) -> int:
        """Algorithm 3's AddNewPath; returns the path's number. `source` is "given" or "camera"."""
        remembered = self._controller.memory.remember(path)
        self._paths += 1
        self._numbers[id(remembered)] = self._paths
        message = pb.PathRemembered(path=self._paths, moves=path.moves, source=source, visit=visit)
        self._publish(topics.PATH, message)
        return self._paths

    def choose(self, state: int) -> int:
        action = self._controller.choose(state)
        self._report_ended(self._controller.ended)
        return action

    def learn(self, transition: Transition) -> None:
        """Eq. 7: the reward is an impulse on arrival in the goal, discounted over the move."""
        arrived = transition.next_state == self._grid.goal
        reward = REWARD_IN_GOAL if arrived else 0.0
        discount = discount_over(transition.duration_s, self._discount_rate_per_s)
        replay = self._controller.replay
        change = self._controller.learn(
            transition.state,
            transition.action,
            discount * reward,
            transition.next_state,
            discount,
            blocked=transition.blocked,
            arrived=arrived,
        )
        self.moves += 1
        self._report_move(transition, reward, change, replay)
        self._report_ended(self._controller.ended)
        self.tracks += arrived
        if self.moves % MOVES_BETWEEN_EVALUATIONS == 0:
            self._report_best_path()

    def abandon(self) -> None:
        """Drop a replay whose move came to nothing; its path is not counted."""
        self._controller.replay = None

    def _report_move(
        self, transition: Transition, reward: float, change: float, replay: Replay | None
    ) -> None:
        self._publish(
            topics.MOVE,
            pb.Move(
                number=self.moves,
                track=self.tracks + 1,
                state=transition.state,
                action=transition.action,
                next_state=transition.next_state,
                reward=reward,
                duration_s=transition.duration_s,
                q_value=self._controller.q.values[transition.state][transition.action],
                q_change=change,
                blocked=transition.blocked,
                path=self._numbers[id(replay.remembered)] if replay else 0,
            ),
        )

    def _report_ended(self, ended: EndedReplay | None) -> None:
        if ended is None:
            return
        self._publish(
            topics.REPLAY,
            pb.Replay(
                path=self._numbers[id(ended.remembered)],
                moves=ended.moves,
                outcome=ended.outcome.value,
                q_change=ended.q_change,
                ratio=self._controller.memory.ratio(ended.remembered),
                started_move=self.moves - ended.moves + 1,
            ),
        )

    def _report_best_path(self) -> None:
        cap = self._path_length_cap
        length = greedy_path_length(self._controller.q, self._grid, self._evaluation_rng, cap)
        self._publish(topics.BEST_PATH, pb.BestPath(move=self.moves, length=length, cap=cap))

    def snapshot(self) -> dict[str, Any]:
        controller = self._controller
        remembered = controller.memory.remembered
        replay = controller.replay
        return {
            "moves": self.moves,
            "tracks": self.tracks,
            "paths": self._paths,
            "q": controller.q.values,
            "memory": [_path_snapshot(entry, self._numbers[id(entry)]) for entry in remembered],
            "replay": replay and [remembered.index(replay.remembered), replay.index, replay.q_change],
            "rng": controller.rng.bit_generator.state,  # type: ignore[attr-defined]
            "evaluation_rng": self._evaluation_rng.bit_generator.state,
        }

    def restore(self, snapshot: dict[str, Any]) -> None:
        controller = self._controller
        if len(snapshot["q"]) != self._grid.states:
            raise ValueError(f"it has {len(snapshot['q'])} states; the grid has {self._grid.states}")
        self.moves, self.tracks, self._paths = snapshot["moves"], snapshot["tracks"], snapshot["paths"]
        controller.q.values = [[float(value) for value in row] for row in snapshot["q"]]
        self._restore_memory(controller.memory, snapshot["memory"])
        if snapshot["replay"]:
            entry, index, q_change = snapshot["replay"]
            controller.replay = Replay(controller.memory.remembered[entry], index, q_change)
        controller.rng.bit_generator.state = snapshot["rng"]  # type: ignore[attr-defined]
        self._evaluation_rng.bit_generator.state = snapshot["evaluation_rng"]

    def _restore_memory(self, memory: ImitationMemory, entries: list[dict[str, Any]]) -> None:
        memory.remembered = []
        for entry in entries:
            path = ObservedPath.parse(entry["moves"])
            counts = (entry["n_replicated"], entry["n_completed"], entry["n_q_plus"])
            remembered = RememberedPath(path, *counts)
            memory.remembered.append(remembered)
            self._numbers[id(remembered)] = entry["number"]


def _path_snapshot(remembered: RememberedPath, number: int) -> dict[str, Any]:
    assert isinstance(remembered.path, ObservedPath)
    return {
        "number": number,
        "moves": [move.name for move in remembered.path.moves],
        "n_replicated": remembered.n_replicated,
        "n_completed": remembered.n_completed,
        "n_q_plus": remembered.n_q_plus,
    }
