"""Every legal setting works: a small run with each key at both ends of its range, alone and in pairs."""

from __future__ import annotations

import dataclasses
import json
import random
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

from swarm.config.experiment import (
    ArenaSettings,
    BodySettings,
    Experiment,
    LearningSettings,
    SimulationSettings,
    TrackerSettings,
    VisitSettings,
)
from swarm.config.toml_files import Between
from swarm.errors import UserError
from swarm.logs.check import check_run
from tests.support.swarm_runs import run_server, write_experiment

Setting = tuple[str, str, Any]
"""Table, key, value."""

TABLES = {
    "learning": LearningSettings,
    "body": BodySettings,
    "tracker": TrackerSettings,
    "visits": VisitSettings,
    "simulation": SimulationSettings,
    "arena": ArenaSettings,
}
NOT_ALONE = {"width_m", "height_m"}
"""The floor must hold the compartments: only those are smaller or larger here."""
NEIGHBOURS = 4
"""On either side: each end is tried with eight others, in 246 of the 1,860 pairs."""
REFUSED: tuple[set[Setting], ...] = (
    {("visits", "duration_s", 600), ("visits", "frames_per_s", 30)},
    {("tracker", "blackouts_per_hour", 600), ("tracker", "blackout_s", 60)},
)
"""Before anything starts: 18,000 frames in one message, and a robot that is never seen."""
MOVES = 6


def ends() -> list[Setting]:
    """Both ends of every range that the settings declare."""
    found: list[Setting] = []
    for table, settings in TABLES.items():
        hints = get_type_hints(settings, include_extras=True)
        for field in dataclasses.fields(settings):
            for range_ in get_args(hints[field.name]):
                if isinstance(range_, Between) and field.name not in NOT_ALONE:
                    found += [(table, field.name, value) for value in (range_.low, range_.high)]
    return found


def text(*settings: Setting) -> str:
    """A learner beside another that watches it, whose floor has room for any compartment."""
    tables: dict[str, dict[str, Any]] = {"arena": {"width_m": 100.0, "height_m": 100.0}}
    tables["visits"] = {"duration_s": 10.0}
    tables["camera"] = {"conditions": "clean"}
    for table, key, value in settings:
        tables.setdefault(table, {})[key] = value
    if tables["visits"]["duration_s"] == 600:
        tables["visits"].setdefault("frames_per_s", 0.5)
    fits_two = not any(key in ("cell_m", "columns", "rows") for _, key, _ in settings)
    if tables["arena"].get("cell_m") == 10:
        tables["arena"] |= {"columns": 5, "rows": 5}
    lines = ["[run]", 'name = "ends"', f"moves = {MOVES}"]
    for table, values in tables.items():
        lines += [f"[{table}]", *(f"{key} = {json.dumps(value)}" for key, value in values.items())]
    lines += ["[[robot]]", 'id = "a"', "south_west_m = [0.0, 1.0]"]
    if fits_two:
        lines += ["[[robot]]", 'id = "b"', 'watches = "a"', "south_west_m = [2.0, 1.0]"]
    return "\n".join(lines) + "\n"


def check(directory: Path, *settings: Setting) -> None:
    result = run_server(write_experiment(directory, text(*settings)), directory / "run", "--processes", "1")
    assert result["moves"] >= MOVES
    (found,) = check_run(directory / "run")
    assert found.sound, found.faults


def named(settings: Any) -> str:
    return str(settings) if isinstance(settings, str) else "-".join(map(str, settings))


A_FEW = [
    setting
    for setting in ends()
    if setting[1] in ("latency_s", "loss", "tick_s", "ticks_per_exchange") and setting[2]
]


@pytest.mark.parametrize("setting", A_FEW, ids=named)
def test_settings_that_slow_robots_down_stop_none(setting: Setting, tmp_path: Path) -> None:
    check(tmp_path, setting)


@pytest.mark.parametrize("pair", REFUSED, ids=["frames", "blackouts"])
def test_what_can_only_fail_together_is_refused(pair: set[Setting], tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"small\.toml:\d+: "):
        Experiment.load(write_experiment(tmp_path, text(*sorted(pair))))


@pytest.mark.faults
@pytest.mark.parametrize("setting", ends(), ids=named)
def test_every_end_of_every_range_works(setting: Setting, tmp_path: Path) -> None:
    check(tmp_path, setting)


def pairs() -> list[tuple[Setting, Setting]]:
    """Each end with its neighbours in a ring into which chance put them all."""
    ring = ends()
    random.Random(4).shuffle(ring)
    neighbours = [
        (one, ring[(place + distance) % len(ring)])
        for distance in range(1, NEIGHBOURS + 1)
        for place, one in enumerate(ring)
    ]
    return [pair for pair in neighbours if pair[0][:2] != pair[1][:2] and set(pair) not in REFUSED]


@pytest.mark.faults
@pytest.mark.parametrize("pair", pairs(), ids=str)
def test_pairs_of_ends_work(pair: tuple[Setting, Setting], tmp_path: Path) -> None:
    check(tmp_path, *pair)
