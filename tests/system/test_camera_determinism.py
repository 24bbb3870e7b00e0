"""Cameras, visits and copying do not depend on how the work is divided over processes."""

from __future__ import annotations

from pathlib import Path

from tests.conftest import SmallRun
from tests.support.swarm_runs import messages, run_server


def test_the_same_seed_gives_the_same_log_with_cameras(watching_run: SmallRun, tmp_path: Path) -> None:
    experiment, apart = watching_run.experiment, watching_run.result
    together = run_server(experiment, tmp_path / "together", "--processes", "1")
    assert apart["digest"] == together["digest"]
    observations = [message for _, message in messages(watching_run.log, "observation")]
    assert len(observations) == 1
    assert len({look.frame_hash for look in observations[0].looks}) == observations[0].frames
    assert observations[0].moves
    other = run_server(experiment, tmp_path / "other", "--processes", "1", "--seed", "2")
    assert other["digest"] != apart["digest"]
