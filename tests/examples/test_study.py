"""The example study runs as `swarm reproduce` runs it."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image

from swarm.cli.reproduce import reproduce_figures
from tests.support.swarm_runs import ROOT

STUDY = ROOT / "examples" / "long_arena.py"


def test_the_study_has_a_curve_for_each_path(tmp_path: Path) -> None:
    results = reproduce_figures([str(STUDY)], runs=2, steps=2000, seed=5, out=tmp_path, jobs=1)
    curves = results["long_arena"]["curves"]
    assert list(curves) == ["no imitation", "5 x SE", "5 x E", "5 x S"]
    assert all(19.0 <= curve["mean"][-1] <= 200.0 for curve in curves.values()), "shortest to never arriving"
    assert matplotlib.image.imread(tmp_path / "2-runs" / "long_arena.png").shape[2] == 4
