"""Judged claims as a page of Markdown and as one HTML file, from the same rows."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from html import escape
from pathlib import Path

from swarm.files import write_text
from swarm.markdown import table
from swarm.paper.assessment import Assessment, Corrected
from swarm.paper.report_json import as_json
from swarm.paper.verdicts.finding import Finding, Tested, Verdict
from swarm.paper.verdicts.judge import Judged
from swarm.paper.verdicts.wording import in_windows
from swarm.statistics.effect_size import EffectSize

COLUMNS = ("compared", "paper's test", "family-wise test", "effect (95 % interval)", "arrivals", "verdict")
CLAIM_COLUMNS = ("figure", "the paper's words", "verdict", "p", "Holm", "Benjamini-Hochberg")

LEGEND = (
    "Paper's test: a paired t-test at each of about 200 points, each on its own. Family-wise: max-T sign "
    "flips of the paired differences, which hold 5 % over all points. Both show where the claim is "
    "supported and, after 'against', where its opposite is; gaps of up to 5 points are overlooked, and "
    "stretches of fewer than 3 points left out. Effect: the mean paired difference over the claimed time, in "
    "moves of the best path unless said otherwise, and Cohen's d_z. A best path that does not arrive counts "
    "as ten times the arena's side, which is most of an early difference: arrivals are the medians of the "
    "first time at which it arrives at all, and at which it is shortest. Pairs of learners are compared with "
    "pairs, by their average; with a single learner, by the first of each pair. Times in brackets are 95 % "
    "intervals of a bootstrap of the pairs. A claim's p is the largest of its comparisons; Holm's keeps 5 % "
    "over all claims, Benjamini and Hochberg's 5 % of those found."
)


def row(finding: Finding) -> tuple[str, ...]:
    """The cells of `COLUMNS`."""
    return (
        finding.compared,
        tested(finding.paper_test),
        tested(finding.family_wise_test),
        effect(finding.effect, finding.effect_unit),
        finding.arrivals or "none",
        f"{finding.verdict.value}: {finding.why}",
    )


def tested(test: Tested | None) -> str:
    """Windows in favour and against, and the smallest p."""
    if test is None:
        return "none"
    against = f"; against {in_windows(test.against)}" if test.against else ""
    places = f"{in_windows(test.windows)}{against}; " if test.in_time else ""
    return f"{places}p {p_value(test.smallest_p)}"


def effect(size: EffectSize | None, unit: str) -> str:
    """The mean difference and d_z."""
    if size is None:
        return "none"
    low, high = size.mean_interval
    d_low, d_high = size.d_z_interval
    difference = f"{number(size.mean_difference)} ({number(low)} to {number(high)}) {unit}"
    return f"{difference}, d_z {size.d_z:.2f} ({d_low:.2f} to {d_high:.2f})"


def number(value: float) -> str:
    """Three figures, without an exponent."""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def p_value(p: float) -> str:
    return "< 0.0001" if p < 0.0001 else f"{p:.2g}"


def summary(assessment: Assessment) -> str:
    """How many claims have which verdict."""
    verdicts = [judged.verdict for judged in assessment.judged]
    counts = [f"{verdict.value}: {verdicts.count(verdict)}" for verdict in Verdict if verdict in verdicts]
    return f"{len(verdicts)} claims; {', '.join(counts)}"


def as_markdown(assessment: Assessment, command: str) -> str:
    """The verdict table, then every comparison; `command` is what made it."""
    verdicts = [
        (one.figure, one.claim.text, f"**{one.verdict.value}**", *corrected_cells(corrected))
        for one, corrected in zip(assessment.judged, assessment.corrected, strict=True)
    ]
    blocks = [
        "# The paper's claims about its simulations, and what was measured",
        f"Made by `{command}`: {assessment.runs} runs of each condition, seed {assessment.seed}. "
        f"{summary(assessment)}.",
        table(CLAIM_COLUMNS, verdicts),
        "## Every comparison",
        LEGEND,
        *(_details(judged) for judged in assessment.judged),
    ]
    return "\n\n".join(blocks) + "\n"


def corrected_cells(corrected: Corrected | None) -> tuple[str, str, str]:
    """p, Holm and Benjamini-Hochberg."""
    if corrected is None:
        return "none", "none", "none"
    return p_value(corrected.p), p_value(corrected.holm), p_value(corrected.benjamini_hochberg)


def _details(judged: Judged) -> str:
    heading = f"### {judged.figure}: {judged.verdict.value}\n\n> {judged.claim.text}"
    return f"{heading}\n\n{table(COLUMNS, map(row, judged.findings))}"


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
    figures = dict.fromkeys(judged.figure for judged in assessment.judged)
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
            f"<style>{STYLE}</style></head><body><h1>{title}</h1><p>{made}</p>",
            _verdict_table(assessment),
            f"<p>{escape(LEGEND)}</p>",
            *(_figure(figure, assessment) for figure in figures),
            "</body></html>\n",
        ]
    )


def _figure(figure: str, assessment: Assessment) -> str:
    plot = assessment.plots.get(figure)
    parts = [f'<h2 id="{figure}">{figure}</h2>', _image(figure, plot) if plot else ""]
    parts += [_claim(judged) for judged in assessment.judged if judged.figure == figure]
    return "\n".join(parts)


def _claim(judged: Judged) -> str:
    words = f"<blockquote>{escape(judged.claim.text)}</blockquote>"
    verdict = f'<p style="background:{COLOURS[judged.verdict]}"><b>{judged.verdict.value}</b></p>'
    return words + verdict + _html_table(COLUMNS, (map(escape, row(finding)) for finding in judged.findings))


def _verdict_table(assessment: Assessment) -> str:
    rows = (
        (
            f'<a href="#{one.figure}">{one.figure}</a>',
            escape(one.claim.text),
            f'<span style="background:{COLOURS[one.verdict]}">{one.verdict.value}</span>',
            *map(escape, corrected_cells(corrected)),
        )
        for one, corrected in zip(assessment.judged, assessment.corrected, strict=True)
    )
    return _html_table(CLAIM_COLUMNS, rows)


def _html_table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    head = "".join(f"<th>{column}</th>" for column in columns)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>" for cells in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _image(name: str, path: Path) -> str:
    encoded = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{name}" src="data:image/png;base64,{encoded}">'


def write_report(assessment: Assessment, command: str, more: str = "") -> dict[str, Path]:
    """Write claims.md, claims.json and claims.html beside the plots; return them by form.

    `more` is what the page of Markdown ends with.
    """
    page = "\n".join(part for part in (as_markdown(assessment, command), more) if part)
    texts = {
        "markdown": ("claims.md", page),
        "json": ("claims.json", json.dumps(as_json(assessment), indent=1, allow_nan=False) + "\n"),
        "html": ("claims.html", as_html(assessment, command)),
    }
    assessment.folder.mkdir(parents=True, exist_ok=True)
    return {form: write_text(text, assessment.folder / name) for form, (name, text) in texts.items()}
