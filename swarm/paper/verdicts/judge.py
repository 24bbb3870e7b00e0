"""The verdict on each comparison of a claim, and on the claim.

A claim holds if the paper's own test finds what the paper says and the family-wise test confirms it; in part,
if only some of that is so. One that is not found at the paper's number of runs does not hold; with fewer
runs that may be a matter of too little data, and it cannot be decided.
"""

from __future__ import annotations

from dataclasses import dataclass

from swarm.paper.claim import (
    Better,
    Check,
    Claim,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    NoDifference,
    ShortestPathMoves,
)
from swarm.paper.verdicts.checks import (
    better,
    finds_shortest_by,
    finds_shortest_sooner,
    higher_ratio,
    no_difference,
    shortest_path_moves,
)
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict, combined
from swarm.paper.verdicts.wording import compared
from swarm.statistics.samples import PairingError


@dataclass(frozen=True)
class Judged:
    """A claim with what was found about each of its comparisons."""

    claim: Claim
    verdict: Verdict
    findings: tuple[Finding, ...]


def judge(claim: Claim, evidence: Evidence) -> Judged:
    """Every comparison of a claim, and its verdict."""
    findings = tuple(_found(check, evidence) for check in claim.checks)
    return Judged(claim, combined([finding.verdict for finding in findings]), findings)


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
        case FindsShortestSooner():
            return finds_shortest_sooner(check, evidence)
        case FindsShortestBy():
            return finds_shortest_by(check, evidence)
        case HigherRatio():
            return higher_ratio(check, evidence)
        case ShortestPathMoves():
            return shortest_path_moves(check)
