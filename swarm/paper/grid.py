"""The claims under every reading: which verdicts an open point of the paper decides."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from swarm.markdown import table
from swarm.paper.assessment import Assessment, assess
from swarm.paper.options import Settings
from swarm.paper.readings import OPTIONS, Readings, single_changes
from swarm.paper.verdicts.finding import Verdict

SIGNS = {
    Verdict.HOLDS: "yes",
    Verdict.IN_PART: "in part",
    Verdict.DOES_NOT_HOLD: "no",
    Verdict.UNDECIDED: "?",
}


@dataclass(frozen=True)
class ReadingsGrid:
    """An assessment of the same claims under each reading, the default first."""

    runs: int
    assessments: tuple[tuple[Readings, Assessment], ...]

    def counts(self, verdict: Verdict) -> list[int]:
        """How many claims have a verdict under each reading."""
        return [
            sum(judged.verdict is verdict for judged in assessment.judged)
            for _, assessment in self.assessments
        ]


def assess_readings(names: Iterable[str], settings: Settings, runs: int) -> ReadingsGrid:
    """One option changed at a time, with the runs that the readings share made once."""
    asked, found = list(names), []
    for readings in single_changes():
        changed = replace(settings, runs=runs, readings=readings)
        found.append((readings, assess(asked, changed, plots=False)))
    return ReadingsGrid(runs, tuple(found))


def as_markdown(grid: ReadingsGrid) -> str:
    """The options, then the verdict on every claim under every reading."""
    options = [(option.name, option.place, ", ".join(option.alternatives), option.why) for option in OPTIONS]
    text = (
        "## Under other readings\n\nWhat the paper leaves open, the default first; then every claim under "
        f"the default and under each alternative alone, of {grid.runs} runs each. `?`: too few."
    )
    blocks = (text, table(("option", "place", "alternatives", "why"), options), _verdicts(grid))
    return "\n\n".join(blocks) + "\n"


def _verdicts(grid: ReadingsGrid) -> str:
    head = ["figure", "claim", *(readings.label for readings, _ in grid.assessments)]
    judged = [assessment.judged for _, assessment in grid.assessments]
    rows: list[Sequence[str]] = [
        (each[0].figure, each[0].claim.text, *(SIGNS[one.verdict] for one in each))
        for each in zip(*judged, strict=True)
    ]
    for verdict in Verdict:
        rows.append(("all", verdict.value, *map(str, grid.counts(verdict))))
    return table(head, rows)


def as_json(grid: ReadingsGrid) -> dict[str, Any]:
    """reading -> the verdict on each claim, and how many hold."""
    return {
        readings.label: {
            "verdicts": [judged.verdict.value for judged in assessment.judged],
            "hold": sum(judged.verdict is Verdict.HOLDS for judged in assessment.judged),
        }
        for readings, assessment in grid.assessments
    }
