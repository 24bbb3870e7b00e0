"""Judged claims as one HTML file with the figures inside, to be sent and opened anywhere."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from pathlib import Path

from swarm.experiments.assessment import Assessment
from swarm.experiments.judging.finding import Verdict
from swarm.experiments.judging.judge import Judged
from swarm.experiments.reports.rows import COLUMNS, LEGEND, row, summary

COLOURS = {
    Verdict.HOLDS: "#d8f0d8",
    Verdict.IN_PART: "#fff2cc",
    Verdict.DOES_NOT_HOLD: "#f8d7d7",
    Verdict.UNDECIDED: "#e4e4e4",
}
STYLE = """
body { font: 15px/1.45 sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em }
table { border-collapse: collapse; margin: 1em 0 }
td, th { border: 1px solid #bbb; padding: .3em .6em; text-align: left; vertical-align: top }
blockquote { border-left: 3px solid #bbb; margin-left: 0; padding-left: 1em }
img { max-width: 100% }
"""


def as_html(assessment: Assessment, command: str) -> str:
    """The verdict table, then each figure with its claims."""
    title = "The paper's claims about its simulations, and what was measured"
    made = (
        f"Made by <code>{escape(command)}</code>: {assessment.runs} runs of each condition, "
        f"seed {assessment.seed}. {escape(summary(assessment))}."
    )
    figures = dict.fromkeys(judged.claim.figure for judged in assessment.judged)
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
            f"<style>{STYLE}</style></head><body><h1>{title}</h1><p>{made}</p>",
            _verdict_table(assessment.judged),
            f"<p>{escape(LEGEND)}</p>",
            *(_figure(figure, assessment) for figure in figures),
            "</body></html>\n",
        ]
    )


def _figure(figure: str, assessment: Assessment) -> str:
    plot = assessment.plots.get(figure)
    parts = [f'<h2 id="{figure}">{figure}</h2>', _image(figure, plot) if plot else ""]
    parts += [_claim(judged) for judged in assessment.judged if judged.claim.figure == figure]
    return "\n".join(parts)


def _claim(judged: Judged) -> str:
    words = f"<blockquote>{escape(judged.claim.text)}</blockquote>"
    verdict = f'<p style="background:{COLOURS[judged.verdict]}"><b>{judged.verdict.value}</b></p>'
    return words + verdict + _table(COLUMNS, (map(escape, row(finding)) for finding in judged.findings))


def _verdict_table(judged: Iterable[Judged]) -> str:
    rows = (
        (
            f'<a href="#{one.claim.figure}">{one.claim.figure}</a>',
            escape(one.claim.text),
            f'<span style="background:{COLOURS[one.verdict]}">{one.verdict.value}</span>',
        )
        for one in judged
    )
    return _table(("figure", "the paper's words", "verdict"), rows)


def _table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    head = "".join(f"<th>{column}</th>" for column in columns)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>" for cells in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _image(name: str, path: Path) -> str:
    encoded = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{name}" src="data:image/png;base64,{encoded}">'
