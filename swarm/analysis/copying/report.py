"""The report's section on copying: errors by kind, what became of miscopied paths, visits in vain."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from swarm.analysis.copying.drawing import moves_text
from swarm.analysis.copying.paths import LoggedPath
from swarm.analysis.copying.summary import Copying
from swarm.markdown import table, text_number

PICTURES = {
    "most_enacted.png": "Paths enacted most often",
    "least_enacted.png": "Paths enacted least often",
    "copies.png": "Originals beside their copies",
    "ratios.png": "R of every path over time",
}
_PAPER_AXES = (
    "[The curves on the axes of the paper's figures 25 and 26](curves_paper_axes.png); "
    "below, its figures 27 to 29 for this run."
)
_SHOWN = 20
_EXPLAINED = (
    "A copy is judged whole: all the moves that were perceived against all that the demonstrator really made "
    "meanwhile. Only a stretch of it is remembered: even a wrong copy may give a path that was really made."
)


def copying_section(copying: Copying, pictures: Iterable[str]) -> str:
    """Markdown; empty for runs in which nobody remembered a path or made a visit."""
    if not copying:
        return ""
    shown = [f"![{words}]({name})" for name, words in PICTURES.items() if name in set(pictures)]
    parts = [
        "## Copying",
        _PAPER_AXES,
        _visits(copying),
        *shown,
        _errors(copying),
        _reinforced(copying),
        _miscopied(copying),
    ]
    return "\n\n".join(part for part in parts if part)


def _visits(copying: Copying) -> str:
    if not copying.visits:
        return ""
    vain = sum(copying.failures.values())
    text = f"{copying.visits} visits, {vain} of which taught nothing."
    if not vain:
        return text
    rows = [[reason or "no reason given", str(count)] for reason, count in copying.failures.items()]
    return f"{text}\n\n{table(['taught nothing because', 'visits'], rows)}"


def _errors(copying: Copying) -> str:
    counts = copying.errors()
    if not sum(counts.values()):
        return ""
    rows = [[str(kind), str(count)] for kind, count in counts.items()]
    return f"### Copying errors\n\n{_EXPLAINED}\n\n{table(['copy', 'number'], rows)}"


def _reinforced(copying: Copying) -> str:
    """Perfect copies against wrong ones."""
    numbers = copying.as_json()
    kinds = {
        "perfect": "copied perfectly",
        "miscopied": "miscopied",
        "miscopied_and_never_made": "of these, the remembered moves never made so",
    }
    if not numbers["perfect"]["paths"] + numbers["miscopied"]["paths"]:
        return ""
    rows = [[words, *_reinforcement(numbers[name])] for name, words in kinds.items()]
    head = ["paths", "number", "replays", "replays a path", "mean R at the end", "highest R"]
    return f"### What was reinforced\n\n{table(head, rows)}"


def _reinforcement(numbers: dict[str, Any]) -> list[str]:
    paths, replays = numbers["paths"], numbers["replays"]
    return [
        str(paths),
        f"{replays:,}",
        text_number(replays / paths if paths else None),
        text_number(numbers["mean_ratio"], 2),
        text_number(numbers["highest_ratio"], 2),
    ]


def _miscopied(copying: Copying) -> str:
    paths = copying.miscopied
    if not paths:
        return ""
    head = [
        "robot",
        "seed",
        "trial",
        "path",
        "remembered",
        "copy",
        "edit distance",
        "replays",
        "R at the end",
    ]
    text = f"The {min(_SHOWN, len(paths))} most replayed of {len(paths)} miscopied paths."
    return f"{text}\n\n{table(head, _rows(paths[:_SHOWN]))}"


def _rows(paths: Sequence[LoggedPath]) -> list[list[str]]:
    return [
        [
            path.robot,
            str(path.seed),
            str(path.trial),
            str(path.path),
            moves_text(path.moves),
            str(path.error),
            str(path.edit_distance),
            f"{path.replays:,}",
            text_number(path.ratio, 2),
        ]
        for path in paths
    ]
