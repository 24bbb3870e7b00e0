"""What `swarm trials` says of the paper's section 3: its claims, and its question as a study."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment


@dataclass(frozen=True)
class AskedTrials:
    """How many trials of which experiments: one in which an expert is copied, and one of two learners."""

    both: tuple[Experiment, Experiment]
    copies: Path
    durations: Path
    trials: int
    jobs: int


def judged_claims(asked: AskedTrials, out: Path) -> dict[str, Any]:
    """Run both experiments, judge section 3's claims, and write claims.md into `out`."""
    from swarm.files import write_text
    from swarm.markdown import table
    from swarm.surrogate.robot_claims import COLUMNS, as_json, judge_robots, rows
    from swarm.surrogate.robot_tests import RobotEvidence
    from swarm.surrogate.trials import run_trials

    stored = asked.copies, asked.durations
    evidence = RobotEvidence(*(run_trials(each, *stored, asked.trials, asked.jobs) for each in asked.both))
    judged = judge_robots(evidence)
    page = write_text(f"{table(COLUMNS, rows(judged))}\n", out / "claims.md")
    return {"trials": asked.trials, "claims": as_json(judged), "files": {"claims": str(page)}}


def studied_errors(asked: AskedTrials, out: Path) -> dict[str, Any]:
    """Run every arm of section 3.5's study, and write embodiment.md into `out`."""
    from swarm.files import write_text
    from swarm.markdown import table
    from swarm.parallel import workers
    from swarm.surrogate.copies import load_copies
    from swarm.surrogate.durations import load_durations
    from swarm.surrogate.embodiment import COLUMNS, as_json, rows, run_study, tasks

    stored = load_copies(asked.copies), load_durations(asked.durations)
    with workers("processes", asked.jobs) as pool:
        found = run_study(tasks(*asked.both), *stored, asked.trials, pool)
    page = write_text(f"{table(COLUMNS, rows(found))}\n", out / "embodiment.md")
    return {"trials": asked.trials, "arms": as_json(found), "files": {"embodiment": str(page)}}


def lines(result: dict[str, Any]) -> list[str]:
    """The result to read."""
    told = [
        f"{one['section']}: {one['verdict']}: {one['text']} ({one['why']})"
        for one in result.get("claims", [])
    ]
    told += [
        f"{one['task']}, {one['arm']}: {one['gain_moves']:+.2f} moves shorter than with true copies"
        f" (p {one['p']:.2g}); benefit: {'yes' if one['benefits'] else 'no'}"
        for one in result.get("arms", [])
    ]
    return [*told, *(f"wrote {path}" for path in result["files"].values())]
