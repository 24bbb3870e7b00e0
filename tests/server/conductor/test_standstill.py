"""How long a robot may stand, at every end of what an experiment may ask for."""

from __future__ import annotations

from pathlib import Path

from server.conductor.standstill import longest_rest_s
from swarm.config.experiment import Experiment
from tests.support.swarm_runs import experiment_text, write_experiment


def test_the_longest_legal_visit_is_no_standstill(tmp_path: Path) -> None:
    text = experiment_text(extra="[visits]\nduration_s = 600\n[learning]\nrest_s = 60")
    assert longest_rest_s(Experiment.load(write_experiment(tmp_path, text))) > 600 + 2 * 60 + 600


def test_a_drive_across_the_widest_cells_is_no_standstill(tmp_path: Path) -> None:
    text = experiment_text((("r0", "learner", False),), extra="[visits]\nduration_s = 1").replace(
        "width_m = 13.0\nheight_m = 1.3", "width_m = 100.0\nheight_m = 100.0\ncell_m = 10.0"
    )
    assert longest_rest_s(Experiment.load(write_experiment(tmp_path, text))) > 600 + 10 * 10 * 2**0.5 / 0.1
