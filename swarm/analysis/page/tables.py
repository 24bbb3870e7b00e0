"""The tables of a page: what `swarm analyze` prints and reports, each number with its source."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from swarm.analysis.comparison import Comparison, NoComparison
from swarm.analysis.copying.drawing import moves_text
from swarm.analysis.copying.paths import LoggedPath
from swarm.analysis.page.sources import Cell, Sources
from swarm.analysis.summary import Summary
from swarm.geometry import Move
from swarm.logs.completeness import health_totals, log_state
from swarm.markdown import text_number
from swarm.messages import topics

MOST_PATHS = 200
"""In the table of paths: the most enacted. All are in `tables/copied_paths.parquet`."""
EVERY_KEY = "every key"


def page_tables(summary: Summary, sources: Sources) -> list[dict[str, Any]]:
    """In the order in which they are read; those without a row are left out."""
    found = [
        _learning(summary, sources),
        _comparisons(summary.comparisons, sources),
        _paths(summary.copying.enacted, sources),
        _copying(summary, sources),
        _logs(summary, sources),
        _health(summary, sources),
    ]
    return [table for table in found if table["rows"]]


def _table(name: str, title: str, note: str, head: Sequence[str], rows: list[list[Cell]]) -> dict[str, Any]:
    return {"name": name, "title": title, "note": note, "head": list(head), "rows": rows}


def _learning(summary: Summary, sources: Sources) -> dict[str, Any]:
    head = ["condition", "trials", "moves", "path at the end", "95 % interval"]
    head += [f"at {summary.threshold} or less", "median moves to it"]
    note = (
        "Path at the end: mean best path length in moves. Last columns: how many trials came down to that "
        "length and stayed there, and after how many moves half of all trials had (Kaplan-Meier)."
    )
    rows = [_condition(name, values, summary, sources) for name, values in summary.conditions().items()]
    return _table("learning", "Learning", note, head, rows)


def _condition(name: str, values: dict[str, Any], summary: Summary, sources: Sources) -> list[Cell]:
    logs, keys = sources.of_condition(name), sources.keys_of_condition(name, topics.BEST_PATH)
    end = values["moves"]
    at_end = sources.of(logs, keys, "mean over trials of the best path's length at the last move", (end, end))
    interval = sources.of(logs, keys, "Student's t interval of that mean, on the scale's logit", (end, end))
    reached = f"trials whose best path came to {summary.threshold} moves or less and stayed there"
    median = "moves until half of the trials had (Kaplan-Meier)"
    low, high, half = values["final_low"], values["final_high"], values["median_moves_to_threshold"]
    count = sources.of(logs, keys, "trials with this condition")
    last = sources.of(logs, keys, "the last move that all of them reported", (end, end))
    band: Cell = "none"
    if low is not None:
        numbers = [sources.number(value, text_number(value), interval) for value in (low, high)]
        band = [numbers[0], " to ", numbers[1]]
    whole = (10, end)
    return [
        name,
        sources.number(values["trials"], str(values["trials"]), count),
        sources.number(end, f"{end:,}", last),
        sources.number(values["final_mean"], text_number(values["final_mean"]), at_end),
        band,
        sources.number(
            values["reached_threshold"],
            f"{values['reached_threshold']} of {values['trials']}",
            sources.of(logs, keys, reached, whole),
        ),
        sources.number(half, text_number(half, 0), sources.of(logs, keys, median, whole)),
    ]


def _comparisons(found: Sequence[Comparison | NoComparison], sources: Sources) -> dict[str, Any]:
    head = ["first minus second", "pairs", "moves", "difference", "95 % interval", "d_z", "p"]
    note = (
        "Of the mean best path length over all moves, in moves; less is better. Pairs are trials of the same "
        "seed and number, p is of Student's paired t-test."
    )
    rows = [_comparison(each, sources) for each in found if isinstance(each, Comparison)]
    return _table("comparisons", "Comparisons", note, head, rows)


def _comparison(found: Comparison, sources: Sources) -> list[Cell]:
    both = (found.first, found.second)
    logs = [log for name in both for log in sources.of_condition(name)]
    keys = {key for name in both for key in sources.keys_of_condition(name, topics.BEST_PATH)}

    def number(value: float, text: str, how: str) -> Cell:
        return sources.number(value, text, sources.of(logs, keys, how, (10, found.moves)))

    effect = found.effect
    of_mean = "mean over pairs of the difference of the mean best path"
    ends = [
        number(end, f"{end:+.1f}", f"Student's t interval of the {of_mean}") for end in effect.mean_interval
    ]
    return [
        f"{found.first} minus {found.second}",
        number(found.pairs, str(found.pairs), "pairs of the same seed and trial"),
        number(found.moves, f"{found.moves:,}", "how far both curves reach"),
        number(effect.mean_difference, f"{effect.mean_difference:+.1f}", of_mean),
        [ends[0], " to ", ends[1]],
        number(effect.d_z, f"{effect.d_z:.2f}", "that difference in standard deviations of the differences"),
        number(found.p, f"{found.p:.2g}", "Student's paired t-test of that difference"),
    ]


def _paths(enacted: Sequence[LoggedPath], sources: Sources) -> dict[str, Any]:
    shown = enacted[:MOST_PATHS]
    note = "Grey: what the demonstrator really did. Blue: what was perceived; a stretch of it is remembered."
    if len(shown) < len(enacted):
        note += f" The {len(shown)} most enacted of {len(enacted)}."
    head = ["robot", "trial", "path", "drawn", "moves", "from", "since move", "replays", "R", "edit distance"]
    return _table("paths", "Copied paths", note, head, [_path(path, sources) for path in shown])


def _path(path: LoggedPath, sources: Sources) -> list[Cell]:
    logs, robot = sources.of_trial(path.log), path.robot
    since = (path.known_from, path.known_from + path.known_for)
    remembered = sources.of(logs, [topics.PATH.key(robot)], f"path {path.path} entered the memory", since)
    replays = sources.of(logs, [topics.REPLAY.key(robot)], f"replays of path {path.path} that ended", since)
    ratio = sources.of(
        logs, [topics.REPLAY.key(robot)], f"R after the last replay of path {path.path}", since
    )
    judged = f"moves to insert, leave out or change in what was perceived in visit {path.visit}"
    error = sources.of(logs, [topics.COPY_ERROR.key(robot)], judged)
    return [
        robot,
        f"{path.trial} of seed {path.seed}",
        sources.number(path.path, str(path.path), remembered),
        {"moves": _names(path.copied or path.moves), "real": _names(path.real or ())},
        moves_text(path.moves),
        path.source,
        sources.number(path.known_from, f"{path.known_from:,}", remembered),
        sources.number(path.replays, f"{path.replays:,}", replays),
        sources.number(path.ratio, text_number(path.ratio, 2), ratio),
        "–"
        if path.edit_distance is None
        else sources.number(path.edit_distance, str(path.edit_distance), error),
    ]


def _names(moves: Sequence[int]) -> list[str]:
    return [Move(move).name for move in moves]


def _copying(summary: Summary, sources: Sources) -> dict[str, Any]:
    copying, logs = summary.copying, sources.all_logs()
    if not copying.visits:
        return _table("copying", "", "", [], [])
    visit, judged = topics.VISIT.key(), topics.COPY_ERROR.key()
    rows = [_count("visits", copying.visits, sources.of(logs, [visit], "visits that ended"), sources)]
    rows += [
        _count(
            f"taught nothing: {reason or 'no reason given'}",
            count,
            sources.of(logs, [visit], "visits that remembered no path"),
            sources,
        )
        for reason, count in copying.failures.items()
    ]
    rows += [
        _count(
            f"copies: {kind}", count, sources.of(logs, [judged], "copies with this kind of error"), sources
        )
        for kind, count in copying.errors().items()
        if count
    ]
    return _table("copying", "Visits and copies", "", ["", "count"], rows)


def _count(name: str, count: int, source: int, sources: Sources) -> list[Cell]:
    return [name, sources.number(count, f"{count:,}", source)]


def _logs(summary: Summary, sources: Sources) -> dict[str, Any]:
    rows = []
    for place, log in enumerate(summary.reading.logs):
        messages = sources.of([place], [EVERY_KEY], "messages in the log")
        state = log_state(summary.reading.health, log.identity, bool(log.damage))
        identity = log.identity
        rows.append(
            [
                identity.path.name,
                identity.run,
                f"{identity.trial} of seed {identity.seed}",
                sources.number(log.messages, f"{log.messages:,}", messages),
                state,
                identity.commit[:12],
                identity.digest[:16],
            ]
        )
    return _table("logs", "Logs", "", ["log", "run", "trial", "messages", "state", "commit", "SHA-256"], rows)


_HEALTH = {
    "missing": "messages missing, by their numbers",
    "missing_events": "of them learning events or orders, which may not be lost",
    "duplicates": "messages that are there twice",
    "rejected": "messages that cannot be decoded",
    "restarts": "restarts of a sender, by key",
}


def _health(summary: Summary, sources: Sources) -> dict[str, Any]:
    totals = health_totals(summary.reading.health)
    rows = [
        _count(words, totals[name], sources.of(sources.all_logs(), [EVERY_KEY], words), sources)
        for name, words in _HEALTH.items()
    ]
    return _table("health", "Health", "", ["", "count"], rows)
