"""Section 3.5's question as a study: do copying errors help, and is it their being the robots' own?

Declared beforehand: an arm *benefits* in a task if, against true copies in the same trials, its mean best
path over the trial is shorter (sign flips, 5 %), *and* its imperfect copies are enacted more than their share
of the memories (permuted within memories, 5 %). One of the two alone is no benefit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from swarm.config.experiment import Experiment
from swarm.learning.expert import Plan, edge_move, expert_move
from swarm.learning.random import spawned_generator
from swarm.parallel import Workers
from swarm.statistics.paired_tests import LEVEL, max_t_test
from swarm.statistics.samples import Curves, mean_level
from swarm.surrogate.copies import Copies, CopyStore
from swarm.surrogate.durations import Durations
from swarm.surrogate.enactment import Share, share_of_imperfect
from swarm.surrogate.mutations import RandomEdits, Shuffled, TrueCopies
from swarm.surrogate.trial import RobotTrial, TrialOutcome
from swarm.surrogate.trials import condition_curves

TRUE, ROBOTS, EDITS, SHUFFLED = "true copies", "the robots' errors", "random edits", "shuffled lists"


@dataclass(frozen=True)
class Task:
    """What is learnt from whom."""

    name: str
    experiment: Experiment
    plan: Plan = expert_move


@dataclass(frozen=True)
class ArmResult:
    """One way of copying in one task, against true copies."""

    task: str
    arm: str
    mean_best_path: float
    gain_moves: float
    """Shorter than with true copies, on average over the trial."""
    p: float
    share: Share | None
    """None where no memory holds both kinds."""

    @property
    def benefits(self) -> bool:
        """The declared outcome."""
        enacted = self.share is not None and self.share.p <= LEVEL
        return self.gain_moves > 0 and self.p <= LEVEL and enacted


def tasks(expert: Experiment, each_other: Experiment) -> tuple[Task, ...]:
    """An expert, each other, and a teacher that knows no diagonal, of whom no true copy is the best."""
    return Task("expert", expert), Task("each other", each_other), Task("edge teacher", expert, edge_move)


def run_study(
    studied: Sequence[Task], store: CopyStore, durations: Durations, trials: int, pool: Workers
) -> list[ArmResult]:
    """Every arm of every task, in the same trials."""
    return [result for task in studied for result in _run_task(task, store, durations, trials, pool)]


def _run_task(
    task: Task, store: CopyStore, durations: Durations, trials: int, pool: Workers
) -> list[ArmResult]:
    def run(copies: Copies) -> list[TrialOutcome]:
        calls = (
            (_without_loners(task.experiment), durations, copies, trial, task.plan) for trial in range(trials)
        )
        return sorted(pool.each(_one_trial, calls), key=lambda outcome: outcome.trial)

    outcomes = {TRUE: run(TrueCopies()), ROBOTS: run(store), EDITS: run(RandomEdits(store))}
    lists = tuple(copied.copied for outcome in outcomes[ROBOTS] for copied in outcome.copies)
    outcomes[SHUFFLED] = run(Shuffled(lists))
    return [_result(task, arm, outcomes[arm], outcomes[TRUE]) for arm in outcomes]


def _one_trial(
    experiment: Experiment, durations: Durations, copies: Copies, trial: int, plan: Plan
) -> TrialOutcome:
    return RobotTrial(experiment, durations, copies, trial, plan).run()


def _without_loners(experiment: Experiment) -> Experiment:
    """Who neither watches nor is watched tells nothing here."""
    watched = {robot.watches for robot in experiment.robot}
    return replace(
        experiment, robot=tuple(each for each in experiment.robot if each.watches or each.id in watched)
    )


def _result(task: Task, arm: str, found: list[TrialOutcome], true: list[TrialOutcome]) -> ArmResult:
    one, other = (_level(task.experiment, outcomes) for outcomes in (found, true))
    gain = float((other.values - one.values).mean())
    seed = task.experiment.run.seed
    p = 1.0
    if np.any(one.values != other.values):
        p = max_t_test(other, one, spawned_generator(seed, task.name, 0, arm, "sign flips")).smallest_p
    memories = [memory for outcome in found for memory in outcome.memories.values() if len(memory) > 1]
    share = share_of_imperfect(memories, spawned_generator(seed, task.name, 0, arm, "permutations"))
    return ArmResult(task.name, arm, float(one.values.mean()), gain, p, share)


def _level(experiment: Experiment, outcomes: list[TrialOutcome]) -> Curves:
    """The mean best path of each trial, as a curve of one point."""
    (curves,) = condition_curves(_without_loners(experiment), outcomes).values()
    return replace(curves, times=np.zeros(1), values=mean_level(curves).values[:, None])


COLUMNS = (
    "task",
    "copies",
    "mean best path",
    "shorter than with true copies",
    "p",
    "enacted",
    "share",
    "p",
    "benefit",
)


def rows(results: Sequence[ArmResult]) -> list[tuple[str, ...]]:
    """The cells of `COLUMNS`."""
    return [
        (
            result.task,
            result.arm,
            f"{result.mean_best_path:.2f}",
            f"{result.gain_moves:+.2f}",
            f"{result.p:.2g}",
            *_share_cells(result.share),
            "yes" if result.benefits else "no",
        )
        for result in results
    ]


def as_json(results: Sequence[ArmResult]) -> list[dict[str, Any]]:
    return [
        vars(result) | {"share": result.share and vars(result.share), "benefits": result.benefits}
        for result in results
    ]


def _share_cells(share: Share | None) -> tuple[str, str, str]:
    return (
        ("none",) * 3
        if share is None
        else (f"{share.enacted:.1%}", f"{share.expected:.1%}", f"{share.p:.2g}")
    )
