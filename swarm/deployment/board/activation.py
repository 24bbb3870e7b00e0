"""Which release runs: one that does not become ready gives way to the one before."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swarm.deployment.board.layout import COMPLETE, Board
from swarm.deployment.board.reporting import BoardError, step
from swarm.deployment.board.waiting import until

Request = dict[str, Any]


def activate(board: Board, request: Request) -> dict[str, Any]:
    """Make a release the one that runs; one whose services do not become ready gives way to that before."""
    with board.held():
        former = board.linked("current")
        states = _changed_to(board, request["release"], former, request["within_s"])
        if former != request["release"]:
            board.link("before", former)
        _prune(board, request["keep"])
    return {"services": states, "before": board.linked("before")}


def go_back(board: Board, request: Request) -> dict[str, Any]:
    """Make the release that ran before the one that runs; once more, and the later one runs again."""
    with board.held():
        current, before = board.linked("current"), board.linked("before")
        if not before:
            raise BoardError("there is no release to go back to")
        states = _changed_to(board, before, current, request["within_s"])
        board.link("before", current)
    return {"services": states, "release": before, "before": current}


def _changed_to(board: Board, release: str, former: str, within_s: float) -> dict[str, str]:
    try:
        return _started(board, release, former, within_s)
    except BoardError as failure:
        raise BoardError(f"{failure}; {_undone(board, release, former, within_s)}") from failure


def _undone(board: Board, release: str, former: str, within_s: float) -> str:
    """What runs now that a release did not become ready."""
    if former == release:
        return "it ran before, and is started again and again"
    if not former:
        for name in board.described(release)["services"]:
            board.services.stop(name)
        board.link("current", "")
        return "nothing runs there now"
    step(f"going back to {former}")
    try:
        _started(board, former, release, within_s)
    except BoardError as failure:
        return f"nor does the release before: {failure}"
    return "the release before runs again"


def _started(board: Board, release: str, former: str, within_s: float) -> dict[str, str]:
    """The states of a release's services, all active; BoardError names those that are not."""
    place, wanted = board.releases / release, board.described(release)["services"]
    for name in board.described(former)["services"]:
        if name not in wanted:
            board.services.stop(name)
    board.link("current", release)
    board.services.install(place)
    for name in wanted:
        step(f"starting {name}")
        board.services.restart(name)
    return _awaited(board, wanted, within_s)


def _awaited(board: Board, names: list[str], within_s: float) -> dict[str, str]:
    states: dict[str, str] = {}

    def settled() -> bool:
        states.update({name: board.services.state(name) for name in names})
        return "starting" not in states.values() or bool(_wrong(states))

    if not until(settled, within_s):
        slow = [name for name, state in states.items() if state == "starting"]
        raise BoardError(f"{', '.join(slow)} did not become ready within {within_s:g} s")
    for name in _wrong(states):
        last = board.services.last_words(name)
        raise BoardError(f"{name} is {states[name]}{f' ({last})' if last else ''}")
    return states


def _wrong(states: Mapping[str, str]) -> list[str]:
    return [name for name, state in states.items() if state not in ("active", "starting")]


def _prune(board: Board, keep: int) -> None:
    """Remove all but the newest releases, and the programs and wheels that none of them needs."""
    kept = {board.linked("current"), board.linked("before")} - {""}
    others = [place for place in board.releases.iterdir() if place.name not in kept]
    others.sort(key=lambda place: place.stat().st_mtime, reverse=True)
    kept |= {place.name for place in others[: max(0, keep - len(kept))]}
    _remove_others(board.releases, kept)
    programs = {board.described(release)["virtual_environment"] for release in kept}
    _remove_others(board.programs, programs)
    records = [json.loads((board.programs / name / COMPLETE).read_text()) for name in programs]
    needed = {wheel.partition("/")[0] for record in records for wheel in record["wheels"]}
    _remove_others(board.wheels, needed)
    for program in board.root.glob("board-*.pyz"):
        if program.name != Path(sys.argv[0]).name:
            program.unlink()


def _remove_others(folder: Path, kept: set[str]) -> None:
    for place in folder.iterdir():
        if place.name not in kept:
            shutil.rmtree(place)
