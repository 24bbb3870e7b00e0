"""`swarm replay`: every learner of a log once more, with its verdict or its state at a move."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.errors import UserError, nearest
from swarm.learning.learner import Learner
from swarm.replay.learner_replay import GivenUp, LearnerReplay
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
    """By robot."""

    @property
    def is_identical(self) -> bool:
        """Whether nothing differs, and nothing is missing."""
        return all(each.first is None and not each.q_values_that_differ for each in self.replays.values())

    def as_json(self) -> dict[str, Any]:
        request = self.request
        return {
            "log": self.recording.identity.name,
            "identical": self.is_identical,
            "moves": sum(each.moves for each in self.replays.values()),
            "with": dict(request.changes),
            "without_paths": sorted(request.without),
            "remarks": self.recording.remarks,
            "robots": {robot: self._robot(replay) for robot, replay in self.replays.items()},
        }

    def _robot(self, replay: LearnerReplay) -> dict[str, Any]:
        said = {
            "moves": replay.moves,
            "first_difference": vars(replay.first) if replay.first else None,
            "diverged": vars(replay.diverged) if replay.diverged else None,
            "q_values_that_differ": replay.q_values_that_differ,
        }
        return said if self.request.at is None else said | {"at": moment(replay.learner)}


def replay_log(request: Request) -> LogReplay:
    """Replay a log's learners; UserError for a robot, path or move that it does not have."""
    recording = read_recording(request.logs)
    replays = {robot: _replayed(robot, request, recording) for robot in _robots(request, recording)}
    return LogReplay(request, recording, replays)


def _replayed(robot: str, request: Request, recording: Recording) -> LearnerReplay:
    """One learner's replay; where the log may be read in several ways, a changed learner is not asked."""
    given_up = None
    if request.is_counterfactual:
        plain = _learner_replay(robot, {}, (), recording)
        plain.run()
        given_up = plain.given_up
    replay = _learner_replay(robot, request.changes, request.without, recording, given_up)
    then = replay.run(request.at)
    if request.at is not None:
        if then is None:
            reason = replay.diverged or f"the log has {replay.moves} moves of it"
            raise UserError(
                f"{robot}: nothing is known of move {request.at}: {reason}; choose an earlier --at"
            )
        replay.learner.restore(then)
    return replay


def _learner_replay(
    robot: str,
    changes: Mapping[str, Any],
    without: Collection[int],
    recording: Recording,
    given_up: Mapping[int, GivenUp] | None = None,
) -> LearnerReplay:
    experiment = recording.experiment(dict(changes))
    settings = experiment.robot_named(robot)
    learner = experiment.learner(settings, recording.identity.trial)
    return LearnerReplay(learner, settings.given_paths(), recording.learning[robot], without, given_up)


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
