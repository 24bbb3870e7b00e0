"""Judged claims as a page of Markdown."""

from __future__ import annotations

from collections.abc import Iterable

from swarm.experiments.assessment import Assessment
from swarm.experiments.judging.judge import Judged
from swarm.experiments.reports.rows import COLUMNS, LEGEND, row, summary


def as_markdown(assessment: Assessment, command: str) -> str:
    """The verdict table, then every comparison; `command` is what made it."""
    verdicts = [
        (judged.claim.figure, judged.claim.text, f"**{judged.verdict.value}**")
        for judged in assessment.judged
    ]
    blocks = [
        "# The paper's claims about its simulations, and what was measured",
        f"Made by `{command}`: {assessment.runs} runs of each condition, seed {assessment.seed}. "
        f"{summary(assessment)}.",
        _table(("figure", "the paper's words", "verdict"), verdicts),
        "## Every comparison",
        LEGEND,
        *(_details(judged) for judged in assessment.judged),
    ]
    return "\n\n".join(blocks) + "\n"


def _details(judged: Judged) -> str:
    heading = f"### {judged.claim.figure}: {judged.verdict.value}\n\n> {judged.claim.text}"
    return f"{heading}\n\n{_table(COLUMNS, map(row, judged.findings))}"


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [columns, tuple("---" for _ in columns), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
