"""The verdict on each comparison of a claim, and on the claim.

A claim holds if the tests of all its comparisons find what the paper says, with the sizes and times that it
names; in part, if only some of that is so. One that is not found at the paper's number of runs does not hold;
with fewer runs that may be a matter of too little data, and it cannot be decided.
"""

from __future__ import annotations

from dataclasses import dataclass

from swarm.paper.claim import (
    Better,
    Check,
    ChosenMore,
    Claim,
    CloserPairs,
    Converged,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    Joins,
    MuchSmallerLoss,
    NoDifference,
    PortionsTested,
    ShortestPathMoves,
)
from swarm.paper.verdicts.arrivals import finds_shortest_by, finds_shortest_sooner
from swarm.paper.verdicts.differences import better
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.facts import converged, portions_tested, shortest_path_moves
from swarm.paper.verdicts.finding import Finding, Verdict, combined
from swarm.paper.verdicts.losses import closer_pairs, much_smaller_loss
from swarm.paper.verdicts.ratios import chosen_more, higher_ratio
from swarm.paper.verdicts.sameness import joins, no_difference
from swarm.paper.verdicts.wording import compared
from swarm.statistics.samples import PairingError


@dataclass(frozen=True)
class Judged:
    """A claim about a figure with what was found about each of its comparisons."""

    figure: str
    claim: Claim
    verdict: Verdict
    findings: tuple[Finding, ...]

    @property
    def p(self) -> float | None:
        """All its comparisons have to hold, so the largest of theirs; None where none is tested."""
        return max((finding.p for finding in self.findings if finding.p is not None), default=None)


def judge(figure: str, claim: Claim, evidence: Evidence) -> Judged:
    """Every comparison of a claim, and its verdict."""
    findings = tuple(_found(check, evidence) for check in claim.checks)
    return Judged(figure, claim, combined([finding.verdict for finding in findings]), findings)


def _found(check: Check, evidence: Evidence) -> Finding:
    """A comparison that these runs cannot make is undecided, with the reason."""
    try:
        return _judged(check, evidence)
    except PairingError as error:
        return Finding(compared(check), Verdict.UNDECIDED, str(error))


def _judged(check: Check, evidence: Evidence) -> Finding:
    match check:
        case Better():
            return better(check, evidence)
        case NoDifference():
            return no_difference(check, evidence)
        case Joins():
            return joins(check, evidence)
        case MuchSmallerLoss():
            return much_smaller_loss(check, evidence)
        case CloserPairs():
            return closer_pairs(check, evidence)
        case FindsShortestSooner():
            return finds_shortest_sooner(check, evidence)
        case FindsShortestBy():
            return finds_shortest_by(check, evidence)
        case HigherRatio():
            return higher_ratio(check, evidence)
        case ChosenMore():
            return chosen_more(check, evidence)
        case Converged():
            return converged(check, evidence)
        case PortionsTested():
            return portions_tested(check, evidence)
        case ShortestPathMoves():
            return shortest_path_moves(check)
