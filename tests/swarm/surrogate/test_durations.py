"""How long moves take: measured in logs, stored, drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from swarm.cli.durations import measured_in
from swarm.errors import UserError
from swarm.geometry import Move
from swarm.surrogate.durations import (
    KINDS,
    Durations,
    Step,
    kind_of,
    load_durations,
    measured,
    write_durations,
)
from tests.conftest import SmallRun


@pytest.mark.parametrize(
    ("heading", "action", "kind"),
    [
        (Move.E, Move.E, "turn0-side"),
        (Move.E, Move.SE, "turn1-diagonal"),
        (Move.E, Move.NE, "turn1-diagonal"),
        (Move.NE, Move.SW, "turn4-diagonal"),
        (Move.SE, Move.W, "turn3-side"),
    ],
)
def test_a_kind_is_the_turn_and_the_way(heading: Move, action: Move, kind: str) -> None:
    assert kind_of(heading, action) == kind
    assert kind in KINDS


def step(
    action: Move, duration_s: float, ended_s: float, *, blocked: bool = False, arrived: bool = False
) -> Step:
    return Step("r", action, blocked, arrived, duration_s, ended_s)


def test_durations_are_sorted_by_what_the_robot_had_to_do() -> None:
    steps = [
        step(Move.E, 1.4, 1.4),
        step(Move.N, 0.5, 1.9, blocked=True),
        step(Move.S, 2.0, 3.9, arrived=True),
        step(Move.SE, 3.0, 27.0),
    ]
    found = measured(steps, {})
    assert found == {
        "turn0-side": [1.4],
        "turn2-side": [2.0],
        "drive_back": [pytest.approx(20.1)],
        "turn4-diagonal": [3.0],
    }, "after the drive back it faces north-west"


def test_a_drive_back_with_a_visit_does_not_count() -> None:
    steps = [step(Move.E, 1.4, 1.4, arrived=True), step(Move.E, 1.4, 60.0)]
    assert "drive_back" in measured(steps, {"r": [0.5, 59.0], "other": [10.0]})
    assert "drive_back" not in measured(steps, {"r": [10.0]})


def test_a_log_is_measured(small_run: SmallRun) -> None:
    """An expert's SE moves without a turn take 1.9 to 2.2 s, as the full simulation shows."""
    found = measured_in([small_run.directory])
    assert sum(map(len, found.values())) > 40
    assert np.median(found["turn0-diagonal"]) == pytest.approx(2.0, abs=0.2)
    assert set(found) <= set(KINDS)


def test_stored_durations_are_drawn(tmp_path: Path) -> None:
    write_durations({kind: [1.5, 2.5] for kind in KINDS}, tmp_path / "d.csv", "how")
    durations, rng = load_durations(tmp_path / "d.csv"), np.random.default_rng(1)
    assert {durations.drawn("drive_back", rng) for _ in range(50)} == {1.5, 2.5}
    with pytest.raises(UserError, match="is there already"):
        write_durations({}, tmp_path / "d.csv", "how")


def test_what_was_not_measured_is_named() -> None:
    with pytest.raises(UserError, match="no duration of turn3-side, drive_back was measured"):
        Durations({kind: [1.0] for kind in KINDS if kind not in ("turn3-side", "drive_back")})


@pytest.mark.parametrize(
    "text", ["kind,duration_s\nturn0-side,fast\n", "kind,duration_s\nturn0-side,-1\n", "a\n1\n"]
)
def test_a_bad_file_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(UserError, match=r"durations .*bad\.csv"):
        load_durations(tmp_path / "bad.csv")
