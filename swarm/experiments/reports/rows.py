"""What every form of the report says of a comparison, in words."""

from __future__ import annotations

from swarm.analysis.effect_size import EffectSize
from swarm.experiments.assessment import Assessment
from swarm.experiments.judging.finding import Finding, Tested, Verdict
from swarm.experiments.judging.wording import in_windows

COLUMNS = ("compared", "paper's test", "honest test", "effect (95 % interval)", "verdict")

LEGEND = (
    "Paper's test: a paired t-test at each of about 200 points, each on its own. Honest test: max-T sign "
    "flips of the paired differences, which hold 5 % over all points. Both show where the claim is "
    "supported and, after 'against', where its opposite is; gaps of up to 5 points are overlooked, and "
    "stretches of fewer than 3 points left out. Effect: the mean paired difference over the claimed time, in "
    "moves of the best path unless said otherwise, and Cohen's d_z. A best path that does not arrive counts "
    "as ten times the arena's side. Two learners that copy each other are one replicate: their average."
)


def row(finding: Finding) -> tuple[str, ...]:
    """The cells of `COLUMNS`."""
    return (
        finding.compared,
        tested(finding.paper_test),
        tested(finding.honest_test),
        effect(finding.effect, finding.effect_unit),
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
