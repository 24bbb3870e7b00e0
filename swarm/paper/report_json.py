"""Judged claims as plain data."""

from __future__ import annotations

from typing import Any

from swarm.paper.assessment import Assessment
from swarm.paper.verdicts.finding import Finding, Tested
from swarm.paper.verdicts.judge import Judged
from swarm.statistics.effect_size import EffectSize
from swarm.statistics.paired_tests import Window


def as_json(assessment: Assessment) -> dict[str, Any]:
    """claims -> a list of {figure, text, verdict, comparisons}; times are in steps."""
    return {
        "runs": assessment.runs,
        "seed": assessment.seed,
        "steps": assessment.steps,
        "claims": [
            _claim(judged) | {"p": corrected and vars(corrected)}
            for judged, corrected in zip(assessment.judged, assessment.corrected, strict=True)
        ],
        "plots": {name: str(path) for name, path in assessment.plots.items()},
    }


def _claim(judged: Judged) -> dict[str, Any]:
    return {
        "figure": judged.figure,
        "text": judged.claim.text,
        "verdict": judged.verdict.value,
        "comparisons": [_finding(finding) for finding in judged.findings],
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "compared": finding.compared,
        "verdict": finding.verdict.value,
        "why": finding.why,
        "paper_test": _tested(finding.paper_test),
        "family_wise_test": _tested(finding.family_wise_test),
        "p": finding.p,
        "arrivals": finding.arrivals,
        "effect": _effect(finding.effect, finding.effect_unit),
    }


def _tested(test: Tested | None) -> dict[str, Any] | None:
    if test is None:
        return None
    windows = {"windows": _windows(test.windows), "windows_against": _windows(test.against)}
    return {"test": test.name, "smallest_p": test.smallest_p, **(windows if test.in_time else {})}


def _windows(windows: tuple[Window, ...]) -> list[list[float]]:
    return [[window.start, window.end] for window in windows]


def _effect(effect: EffectSize | None, unit: str) -> dict[str, Any] | None:
    if effect is None:
        return None
    return {
        "unit": unit,
        "mean_difference": effect.mean_difference,
        "mean_interval": list(effect.mean_interval),
        "d_z": effect.d_z,
        "d_z_interval": list(effect.d_z_interval),
        "pairs": effect.pairs,
    }
