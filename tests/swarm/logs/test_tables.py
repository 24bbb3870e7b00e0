"""What a person finds in the tables: journeys and visits as rows, compass names, cells, seconds, units."""

from __future__ import annotations

import json

import polars as pl
import pytest

from swarm.analysis.inputs import find_inputs
from swarm.analysis.table_reference import markdown_page
from swarm.geometry import Move
from swarm.logs.parquet import read_logs
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog
from tests.support.swarm_runs import ROOT


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> dict[str, pl.DataFrame]:
    """Two journeys of three and one moves, and a visit that copied two moves."""
    folder = tmp_path_factory.mktemp("log")
    log = SmallLog(folder / "trial-000.mcap")
    moves = ((1, 0, 11, 0.0), (1, 11, 11, 0.0), (1, 88, 99, 10.0), (2, 0, 11, 0.0))
    for number, (track, state, entered, reward) in enumerate(moves, start=1):
        move = pb.Move(number=number, track=track, state=state, action=Move.SE, next_state=entered)
        move.reward, move.duration_s, move.blocked = reward, 0.05, state == entered
        log.add("robot/imitator/move", move)
    for phase in (pb.Visit.READY, pb.Visit.WATCHING):
        log.add("robot/imitator/visit", pb.Visit(visit=1, phase=phase))
    log.add("robot/imitator/observation", pb.Observation(visit=1, profile="best", frames=9, moves=[1, 0]))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.DONE, path=4))
    error = pb.CopyError(visit=1, path=4, demonstrator="expert", true_moves=[1, 1], copied_moves=[1, 0])
    error.edit_distance = 1
    log.add("server/imitator/copy_error", error)
    log.close()
    found = read_logs(find_inputs([folder]).logs, folder, True, lambda _: None).tables
    units = json.loads(pl.read_parquet_metadata(found["moves"])["units"])
    assert (units["duration_s"], units["receive_t_ns"]) == ("s", "ns of the run's time")
    assert "blocked" not in units
    return {name: pl.read_parquet(path) for name, path in found.items()}


def test_moves_have_compass_names_cells_and_seconds(tables: dict[str, pl.DataFrame]) -> None:
    move = tables["moves"].row(2, named=True)
    assert (move["action"], move["column"], move["row"]) == ("SE", 8, 8)
    assert (move["next_column"], move["next_row"]) == (9, 9)
    assert move["t_s"] == pytest.approx(0.3)
    assert tables["observations"]["moves"].to_list() == [["SE", "E"]]


def test_a_journey_is_a_row(tables: dict[str, pl.DataFrame]) -> None:
    first, second = tables["journeys"].iter_rows(named=True)
    assert (first["moves"], first["blocked_moves"], first["arrived"]) == (3, 1, True)
    assert (first["began_t_s"], first["ended_t_s"]) == (pytest.approx(0.05), pytest.approx(0.3))
    assert (second["track"], second["moves"], second["arrived"]) == (2, 1, False)


def test_a_visit_is_a_row(tables: dict[str, pl.DataFrame]) -> None:
    (visit,) = tables["visits"].iter_rows(named=True)
    assert (visit["ready_t_s"], visit["done_t_s"]) == (pytest.approx(0.5), pytest.approx(0.8))
    assert (visit["path"], visit["frames"], visit["demonstrator"]) == (4, 9, "expert")
    assert (visit["true_moves"], visit["copied_moves"]) == (["SE", "SE"], ["SE", "E"])
    assert tables["visit_phases"].height == 3


def test_the_documentation_is_that_of_the_tables() -> None:
    """If this fails: make docs."""
    assert (ROOT / "docs" / "tables.md").read_text(encoding="utf-8") == markdown_page()
