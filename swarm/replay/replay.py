"""`swarm replay`: every learner of a log once more, with its verdict or its state at a move."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.errors import UserError, nearest
from swarm.learning.learner import Learner
from swarm.replay.learner_replay import LearnerReplay
from swarm.replay.recorded import Recording, read_recording


@dataclass(frozen=True)
class Request:
    """What is asked of a log."""

    logs: tuple[Path, ...]
    """Of one trial."""
    robot: str = ""
    """Of which robot; all learners if empty."""
    at: int | None = None
    """After how many moves to stop."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Of the experiment's [learning]."""
    without: Collection[int] = ()
    """Numbers of paths that are not remembered."""

    @property
    def is_counterfactual(self) -> bool:
        return bool(self.changes or self.without)


@dataclass(frozen=True)
class LogReplay:
    """What came of it, robot by robot."""

    request: Request
    recording: Recording
    replays: dict[str, LearnerReplay]

    @property
    def is_identical(self) -> bool:
        """Whether nothing differs, and nothing is missing."""
        return all(each.first is None and not each.q_values_that_differ for each in self.replays.values())

    def as_json(self) -> dict[str, Any]:
        request = self.request
        return {
            "log": self.recording.identity.name,
            "identical": self.is_identical,
            "moves": sum(each.learner.moves for each in self.replays.values()),
            "with": dict(request.changes),
            "without_paths": sorted(request.without),
            "remarks": self.recording.remarks,
            "robots": {robot: self._robot(replay) for robot, replay in self.replays.items()},
        }

    def _robot(self, replay: LearnerReplay) -> dict[str, Any]:
        said = {
            "moves": replay.learner.moves,
            "first_difference": vars(replay.first) if replay.first else None,
            "diverged": vars(replay.diverged) if replay.diverged else None,
            "q_values_that_differ": replay.q_values_that_differ,
        }
        return said if self.request.at is None else said | {"at": moment(replay.learner)}


def replay_log(request: Request) -> LogReplay:
    """Replay a log's learners; UserError for a robot, path or move that it does not have."""
    recording = read_recording(request.logs)
    experiment = recording.experiment(dict(request.changes))
    replays = {}
    for robot in _robots(request, recording):
        settings = experiment.robot_named(robot)
        learner = experiment.learner(settings, recording.identity.trial)
        replay = LearnerReplay(learner, settings.given_paths(), recording.learning[robot], request.without)
        replay.run(request.at)
        if request.at is not None:
            _check_arrived(robot, replay, request.at)
        replays[robot] = replay
    return LogReplay(request, recording, replays)


def moment(learner: Learner) -> dict[str, Any]:
    """A learner as it is: its table (state, action), and the paths in its memory with R and p_imitate."""
    memory, replay = learner.controller.memory, learner.controller.replay
    return {
        "q_table": learner.controller.q.snapshot(),
        "memory": [
            {
                "path": each.number,
                "moves": str(each.path),
                "replayed": each.n_replicated,
                "completed": each.n_completed,
                "improved": each.n_q_plus,
                "ratio": memory.ratio(each),
                "p_imitate": memory.p_imitate(each),
            }
            for each in memory.remembered
        ],
        "replaying": replay.snapshot() if replay else None,
    }


def _robots(request: Request, recording: Recording) -> list[str]:
    learners = sorted(recording.learning)
    if request.robot and request.robot not in learners:
        raise UserError(
            f"{request.logs[0]}: has no learner {request.robot!r}; {nearest(request.robot, learners)}"
        )
    robots = [request.robot] if request.robot else learners
    paths = {path for robot in robots for path in recording.learning[robot].paths}
    for number in set(request.without) - paths:
        raise UserError(f"{request.logs[0]}: no path {number} was remembered; known: {sorted(paths)}")
    return robots


def _check_arrived(robot: str, replay: LearnerReplay, move: int) -> None:
    if replay.diverged:
        raise UserError(
            f"{robot}: nothing is known of move {move}: {replay.diverged}; choose an earlier --at"
        )
    if replay.learner.moves != move:
        raise UserError(f"{robot}: made {replay.learner.moves} moves; choose --at from 1 to that")
