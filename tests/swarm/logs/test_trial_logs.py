"""Logs of one trial that several servers recorded: one trial, and nothing missing between them unsaid."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl
import pytest

from swarm.analysis.analyze import Request, analyze
from swarm.analysis.recorded_run import RecordedRun
from swarm.cli.check import check_command
from swarm.errors import RunFailedError, UserError
from swarm.logs.check import check_run
from swarm.logs.identity import identify
from tests.support.small_logs import SmallLog, metadata


def part_of(run: Path, part: int, run_id: str = "0123456789ab", name: str = "") -> SmallLog:
    """The log of a trial's first or a later server, with the drawings that each makes anew."""
    run.mkdir(exist_ok=True)
    later = "" if part == 1 else f"-{part}"
    about = metadata()
    about["run"] |= {"id": run_id, "part": str(part)}
    log = SmallLog(run / (name or f"trial-000{later}.mcap"), about)
    log.t_ns = part * 1_000_000_000_000
    return log


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A learner's first 40 moves in one log, the next 40 in another, and none missing between them."""
    run = tmp_path / "run"
    first, second = part_of(run, 1), part_of(run, 2)
    first.add_curve("loner", (100, 90, 80, 70))
    second._numbers.update(first._numbers)
    second.add_curve("loner", (60, 50, 40, 30), first_move=50)
    for log in (first, second):
        log.close()
    return run


def test_they_are_analyzed_as_one_trial(run: Path) -> None:
    analysis = analyze(Request([run], run / "out"))
    curve = pl.read_parquet(analysis.files["trials.parquet"])
    assert curve["move"].to_list() == [10, 20, 30, 40, 50, 60, 70, 80]
    assert curve["best_path_length"].to_list() == [100, 90, 80, 70, 60, 50, 40, 30]
    assert curve["trial"].unique().to_list() == [0]
    recorded = RecordedRun(run)
    assert [log.part for log in recorded.logs] == [1, 2]
    trial = recorded.table("best_paths").select("log").unique().collect()
    assert trial["log"].to_list() == [str(run / "trial-000.mcap")]


def test_nothing_is_missing_between_them(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (found,) = check_run(run)
    assert (found.sound, found.messages) == (True, 8)
    check_command(run)
    assert "trial-000.mcap: complete and sound, 8 messages" in capsys.readouterr().out
    check_command(run, json=True)
    assert json.loads(capsys.readouterr().out)["sound"] is True


def test_what_is_missing_between_them_is_named(tmp_path: Path) -> None:
    first, second = part_of(tmp_path / "run", 1), part_of(tmp_path / "run", 2)
    first.add_curve("loner", (100, 90))
    second._numbers["robot/loner/best_path", 1] = 5
    second.add_curve("loner", (60, 50), first_move=60)
    for log in (first, second):
        log.close()
    (found,) = check_run(tmp_path / "run")
    assert found.faults == ["robot/loner/best_path: 3 messages missing"]
    with pytest.raises(RunFailedError, match="is not sound: robot/loner/best_path: 3 messages missing"):
        check_command(tmp_path / "run")


def test_another_run_s_log_and_a_part_that_is_there_twice_are_no_parts(run: Path) -> None:
    stray = part_of(run, 2, run_id="ba9876543210", name="trial-000-3.mcap")
    stray.add_curve("loner", (60,))
    stray.close()
    with pytest.raises(UserError, match="is in both"):
        analyze(Request([run], run / "out"))
    (run / "trial-000-3.mcap").write_bytes((run / "trial-000-2.mcap").read_bytes())
    with pytest.raises(UserError, match="is in both"):
        analyze(Request([run], run / "out"))


def test_a_log_of_a_simulation_is_its_only_part(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "trial-000.mcap")
    log.add_curve("loner", (60,))
    identity = identify(log.close())
    assert (identity.run_id, identity.part, identity.trial_log) == ("", 1, str(tmp_path / "trial-000.mcap"))
