"""Cameras, visits and copying do not depend on how the work is divided over processes."""

from __future__ import annotations

from pathlib import Path

from tests.support.camera_runs import camera_experiment_text
from tests.support.swarm_runs import messages, run_server, write_experiment


def test_the_same_seed_gives_the_same_log_with_cameras(tmp_path: Path) -> None:
    text = camera_experiment_text(moves=4, names=("expert", "pupil"))
    experiment = write_experiment(tmp_path, text)
    apart = run_server(experiment, tmp_path / "apart")
    together = run_server(experiment, tmp_path / "together", "--processes", "1")
    assert apart["digest"] == together["digest"]
    observations = [message for _, message in messages(tmp_path / "apart" / "trial-000.mcap", "observation")]
    assert len(observations) == 1
    assert len({look.frame_hash for look in observations[0].looks}) == observations[0].frames
    assert observations[0].moves
    other = run_server(experiment, tmp_path / "other", "--processes", "1", "--seed", "2")
    assert other["digest"] != apart["digest"]
