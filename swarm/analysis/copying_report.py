"""The report's section on copying: errors by kind, what became of miscopied paths, visits in vain."""

from __future__ import annotations

from collections.abc import Iterable

from swarm.analysis.copied_paths import Copying

PICTURES = {
    "most_enacted.png": "Paths enacted most often",
    "least_enacted.png": "Paths enacted least often",
    "copies.png": "Originals and copies",
    "ratios.png": "R of every path over time",
}


def copying_section(copying: Copying, pictures: Iterable[str]) -> str:
    """Markdown; empty for a run in which nobody remembered a path or made a visit."""
    if not copying.paths and not copying.visits:
        return ""
    parts = ["## Copying", *(f"![{PICTURES[name]}]({name})" for name in pictures)]
    numbers = copying.as_json()
    if copying.visits:
        parts.append(_errors(copying))
    for name, words in (("perfect", "copied perfectly"), ("miscopied", "miscopied")):
        of_kind = numbers[name]
        if of_kind["paths"]:
            ratio = "none" if of_kind["mean_ratio"] is None else f"{of_kind['mean_ratio']:.2f}"
            enacted = f"{of_kind['replays']:,} replays, mean R at the end {ratio}"
            parts.append(f"{of_kind['paths']} paths {words}: {enacted}.")
    return "\n\n".join(parts)


def _errors(copying: Copying) -> str:
    """Kinds of errors and reasons of failures, as one table."""
    numbers = copying.as_json()
    rows = [f"| copied: {kind} | {count} |" for kind, count in sorted(numbers["errors"].items())]
    rows += [f"| learnt nothing: {reason} | {count} |" for reason, count in sorted(copying.failures.items())]
    return "\n".join([f"| {copying.visits} visits | number |", "| --- | --- |", *rows])
