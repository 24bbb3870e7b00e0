"""What a log has to say of how it was made. All of it is the same in every repetition of a run."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from swarm.config.experiment import Experiment
from swarm.runtime.identity import RunIdentity

PACKAGES = ("swarm-runtime", "eclipse-zenoh", "numpy", "protobuf", "mcap")


def metadata(
    experiment: Experiment,
    file: Path,
    changes: Sequence[str],
    identity: RunIdentity,
    versions: dict[str, str],
    part: int = 1,
) -> dict[str, dict[str, str]]:
    """The metadata records of a trial's log; `versions` are those at the run's beginning, and `changes` what
    `--set` said in place of values of the experiment, whose file has them.

    A run that others can join also says its id and fingerprint, and the log of a server that went on with a
    trial which of the trial's logs it is.
    """
    run = experiment.run
    joinable = {"id": identity.run_id, "identity": str(identity.fingerprint)} if identity.run_id else {}
    later = {"part": str(part)} if part > 1 else {}
    changed = {"set": "\n".join(changes)} if changes else {}
    return {
        "experiment": {"toml": file.read_text(encoding="utf-8"), **changed},
        "run": {
            "name": run.name,
            "seed": str(run.seed),
            "moves": str(run.moves),
            "trial": str(identity.trial),
            **joinable,
            **later,
        },
        "robots": {robot.id: f"{robot.role.value} {robot.group}" for robot in experiment.robot},
        "versions": versions,
    }


def commit() -> str:
    """The git commit of the program, with "+changes" if files differ from it; "unknown" outside git."""
    here = Path(__file__).parents[1]
    found = _git(here, "rev-parse", "HEAD")
    if not found:
        return "unknown"
    return found + ("+changes" if _git(here, "status", "--porcelain", "--untracked-files=no") else "")


def _git(here: Path, *arguments: str) -> str:
    try:
        answer = subprocess.run(["git", *arguments], cwd=here, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return answer.stdout.strip() if answer.returncode == 0 else ""


def versions() -> dict[str, str]:
    """The program's commit, and the versions of Python and of the packages that shape a log."""
    found = {"python": sys.version.split()[0], "commit": commit()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "unknown"
    return found
