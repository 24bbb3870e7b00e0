"""`swarm analyze`: from logs of known content to tables, curves, statistics, and honest refusals."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import polars as pl
import pytest
import zstandard
from scipy import stats

from swarm.analysis.analyze import Analysis, Request, analyze
from swarm.analysis.comparison import Comparison, NoComparison
from swarm.cli.main import main
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog, learning_log, metadata

FAST = ((80, 40, 12, 9), (60, 30, 9, 9), (100, 45, 10, 9))
SLOW = ((100, 100, 90, 60), (100, 95, 70, 50), (100, 99, 95, 40))


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run of three trials, two conditions, four points a curve."""
    folder = tmp_path / "run"
    folder.mkdir()
    for trial, (fast, slow) in enumerate(zip(FAST, SLOW, strict=True)):
        learning_log(folder / f"trial-{trial:03}.mcap", {"imitator": fast, "loner": slow}, trial)
    return folder


def analyzed(*runs: Path, out: Path | None = None) -> Analysis:
    return analyze(Request(runs, out))


def table(analysis: Analysis, name: str) -> pl.DataFrame:
    return pl.read_parquet(analysis.files[name])


def test_the_curve_is_the_mean_over_trials_with_an_interval_on_the_scale(tmp_path: Path) -> None:
    firsts = (80, 60, 100, 100, 95)
    for trial, first in enumerate(firsts):
        learning_log(tmp_path / f"trial-{trial:03}.mcap", {"imitator": (first, 60 + trial, 9)}, trial)
    curve = pl.read_csv(analyzed(tmp_path).files["curves.csv"])
    assert curve["move"].to_list() == [10, 20, 30]
    assert curve["trials"].to_list() == [5] * 3
    low, high = stats.t.interval(0.95, 4, loc=87, scale=stats.sem(firsts))
    assert curve["mean"][0] == 87
    assert high > 100 > curve["high"][0] > 87
    assert low > curve["low"][0] > 9, "on the logit's axis the side away from the end of the scale is longer"
    assert curve["low"][2] == 9 < curve["high"][2] < 100, "a trial may learn at half of the slowest's pace"


def test_too_few_trials_are_shown_one_by_one(run: Path) -> None:
    analysis = analyzed(run)
    assert pl.read_csv(analysis.files["curves.csv"])["low"].null_count() == 8
    assert analysis.as_json()["conditions"]["no-imitation"]["final_of_each_trial"] == [60, 50, 40]
    report = analysis.files["report.md"].read_text()
    assert "none; trials: 40.0, 50.0, 60.0" in report
    assert "of fewer than 4 no interval can be given" in report


def test_everything_that_is_promised_is_written(run: Path) -> None:
    analysis = analyzed(run)
    assert analysis.directory == run / "analysis"
    assert all(path.stat().st_size > 0 for path in analysis.files.values())
    assert analysis.files["curves.png"].read_bytes().startswith(b"\x89PNG")
    curves = table(analysis, "curves.parquet")
    assert curves.equals(pl.read_csv(analysis.files["curves.csv"], schema=curves.schema))
    summary = json.loads((analysis.directory / "summary.json").read_text())
    assert summary == analysis.as_json()
    assert summary["conditions"]["imitation"]["median_moves_to_threshold"] == 30
    assert summary["conditions"]["no-imitation"]["reached_threshold"] == 0
    report = analysis.files["report.md"].read_text()
    assert "counts as 100" in report
    assert "(curves.png)" in report


def test_the_same_logs_give_the_same_bytes_and_may_be_written_over(run: Path) -> None:
    first = {name: path.read_bytes() for name, path in analyzed(run).files.items()}
    again = {name: path.read_bytes() for name, path in analyzed(run).files.items()}
    assert first == again


def test_results_of_other_logs_and_other_things_are_not_written_over(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    analyzed(run / "trial-000.mcap", out=out)
    before = (out / "report.md").read_bytes()
    with pytest.raises(UserError, match="other logs"):
        analyzed(run, out=out)
    assert (out / "report.md").read_bytes() == before
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("precious")
    with pytest.raises(UserError, match="something else"):
        analyzed(run, out=tmp_path / "mine")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["notes.txt"]


def test_one_trial_has_no_interval_and_no_test(run: Path) -> None:
    analysis = analyzed(run / "trial-001.mcap")
    assert analysis.directory == run / "trial-001-analysis"
    assert table(analysis, "curves.parquet")["low"].null_count() == 8
    (found,) = analysis.summary.comparisons
    assert isinstance(found, NoComparison)
    assert "1 pair; at least 2" in found.reason
    assert "no interval can be given" in analysis.files["report.md"].read_text()


def test_trials_of_the_same_seed_and_number_are_pairs(run: Path) -> None:
    (found,) = analyzed(run).summary.comparisons
    assert isinstance(found, Comparison)
    assert found.pairs == 3
    fast = [sum(curve) / 4 for curve in FAST]
    slow = [sum(curve) / 4 for curve in SLOW]
    assert math.isclose(found.p, stats.ttest_rel(fast, slow).pvalue)


def test_unpaired_trials_are_not_tested_as_pairs(tmp_path: Path) -> None:
    for seed in (1, 2):
        for trial in (0, 1):
            robot = "imitator" if seed == 1 else "loner"
            robots = {robot: "learner imitation" if seed == 1 else "learner no-imitation"}
            log = SmallLog(tmp_path / f"{seed}-{trial}.mcap", metadata(trial, seed, robots))
            log.add_curve(robot, FAST[trial])
            log.close()
    analysis = analyzed(*sorted(tmp_path.glob("*.mcap")), out=tmp_path / "out")
    (found,) = analysis.summary.comparisons
    assert isinstance(found, NoComparison)
    assert "same seeds" in found.reason


def test_unequal_lengths_are_cut_to_the_shortest_and_that_is_said(run: Path) -> None:
    learning_log(run / "trial-003.mcap", {"imitator": (70, 50), "loner": SLOW[0]}, trial=3)
    analysis = analyzed(run)
    moves = table(analysis, "curves.parquet").group_by("condition").agg(pl.col("move").max())
    assert dict(moves.iter_rows()) == {"imitation": 20, "no-imitation": 40}
    (note,) = analysis.summary.notes
    assert "cut to 20 moves, where imitator ends in trial 3 of seed 1" in note
    assert note in analysis.files["report.md"].read_text()


def test_a_point_that_one_trial_lost_is_left_out_of_all(run: Path) -> None:
    log = SmallLog(run / "trial-003.mcap", metadata(3))
    log.add_curve("imitator", (90,))
    log.add_curve("imitator", (50, 30), first_move=30)
    log.add_curve("loner", SLOW[0])
    log.close()
    analysis = analyzed(run)
    curve = table(analysis, "curves.parquet").filter(condition="imitation")
    assert curve["move"].to_list() == [10, 30, 40]
    assert any("1 points are missing" in note for note in analysis.summary.notes)


def test_what_a_restarted_learner_reports_again_counts_once(run: Path) -> None:
    log = SmallLog(run / "trial-003.mcap", metadata(3))
    log.add_curve("imitator", (90, 70), epoch=5)
    log.add_curve("imitator", (55, 30, 20), epoch=9, first_move=20)
    log.add_curve("loner", SLOW[0])
    log.close()
    analysis = analyzed(run)
    trials = table(analysis, "trials.parquet").filter(condition="imitation", trial=3)
    assert trials["best_path_length"].to_list() == [90, 55, 30, 20]
    assert analysis.as_json()["health"]["restarts"] == 1


def test_two_learners_of_one_condition_in_one_trial_are_one_replicate(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "pair.mcap", metadata(robots={"a": "learner both", "b": "learner both"}))
    log.add_curve("a", (100, 20))
    log.add_curve("b", (50, 10))
    log.close()
    curve = table(analyzed(tmp_path / "pair.mcap"), "curves.parquet")
    assert curve["trials"].to_list() == [1, 1]
    assert curve["mean"].to_list() == [75, 15]


def test_a_trial_counts_once(run: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.mcap"
    copy.write_bytes((run / "trial-000.mcap").read_bytes())
    with pytest.raises(UserError, match="given twice"):
        analyzed(run, copy, out=tmp_path / "out")
    other = learning_log(tmp_path / "other.mcap", {"loner": SLOW[1]}, trial=0)
    with pytest.raises(UserError, match="another --seed"):
        analyzed(run, other, out=tmp_path / "out")
    with pytest.raises(UserError, match="--out"):
        analyzed(run, copy)


def test_two_runs_in_one_directory_are_told_apart(run: Path) -> None:
    learning_log(run / "trial-007.mcap", {"imitator": FAST[0], "loner": SLOW[0]}, trial=0, seed=2)
    with pytest.raises(UserError, match=r"trial-000\.mcap and trial-007\.mcap are of two different runs"):
        analyzed(run)


def test_trials_that_the_manifest_promises_are_missed(run: Path) -> None:
    records = [{"log": f"trial-{trial:03}.mcap", "state": "complete"} for trial in range(5)]
    records[1]["state"] = "interrupted"
    (run / "manifest.json").write_text(json.dumps({"trials": records}))
    notes = analyzed(run).summary.notes
    assert any("2 of 5 trials have no log: trial-003.mcap, trial-004.mcap" in note for note in notes)
    assert any("trial-001.mcap was interrupted" in note for note in notes)


def test_a_torn_log_is_analyzed_up_to_the_tear(tmp_path: Path) -> None:
    small = SmallLog(tmp_path / "whole.mcap", flush_every=4)
    small.add_curve("loner", range(100, 60, -1))
    data = small.close().read_bytes()
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(data[: data.rindex(zstandard.FRAME_HEADER)])
    analysis = analyzed(torn)
    points = table(analysis, "best_paths").height
    assert points in range(4, 40, 4)
    assert any("cut short" in note and f"after {points} messages" in note for note in analysis.summary.notes)


def test_tables_hold_every_field_and_where_it_comes_from(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "log.mcap", metadata(trial=2, seed=7))
    log.add_curve("loner", (30,))
    log.add("robot/loner/move", pb.Move(number=1, action=3, duration_s=2.5, blocked=True))
    log.add("robot/loner/path", pb.PathRemembered(path=1, moves=[1, 1, 0], source="given"))
    log.add("server/event", pb.Event(level=pb.Event.WARNING, name="slow", text="a key"))
    log.close()
    analysis = analyzed(tmp_path / "log.mcap")
    move = table(analysis, "moves").row(0, named=True)
    origin = {"seed": 7, "trial": 2, "condition": "no-imitation", "robot": "loner", "epoch": 1, "sequence": 1}
    assert move.items() >= origin.items()
    assert move["publish_t_ns"] == 200_000_000
    assert (move["action"], move["duration_s"], move["blocked"]) == ("SW", 2.5, True)
    assert table(analysis, "paths")["moves"].to_list() == [["SE", "SE", "E"]]
    event = table(analysis, "events").row(0, named=True)
    assert (event["robot"], event["condition"], event["level"]) == ("server", "", "WARNING")
    assert table(analysis, "poses").height == 0


def test_messages_that_break_their_promise_are_counted_and_left_out(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "log.mcap")
    log.add_curve("loner", (30, 20))
    log.add("robot/loner/pose", pb.Pose(x_m=0.5))
    log.add("robot/loner/pose", pb.Pose(x_m=math.nan))
    log.add("robot/loner/pose", b"\xff\xff")
    log.add(
        "robot/loner/best_path", pb.BestPath(move=30, length=9, cap=100).SerializeToString() + b"\xf8\x07\x01"
    )
    log.close()
    analysis = analyzed(tmp_path / "log.mcap")
    assert table(analysis, "poses")["x_m"].to_list() == [0.5]
    assert table(analysis, "best_paths")["length"].to_list() == [30, 20, 9]
    assert analysis.as_json()["health"]["rejected"] == 2
    assert any("robot/loner/pose number 2: Pose.x_m is nan" in note for note in analysis.summary.notes)


def test_health_counts_gaps_duplicates_restarts_and_rates(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "log.mcap")
    log.add_curve("loner", (30,))
    for sequence in (2, 3, 3, 6, 10, 9):
        log.add("robot/loner/command", pb.Command(), sequence=sequence)
    log.add("robot/loner/command", pb.Command(), epoch=2)
    log.close()
    health = table(analyzed(tmp_path / "log.mcap"), "health").filter(key="robot/loner/command")
    first, second = health.rows(named=True)
    assert (first["first_sequence"], first["last_sequence"], first["messages"]) == (2, 10, 6)
    assert (first["missing"], first["gaps"]) == (5, 3)
    assert (first["duplicates"], first["out_of_order"]) == (1, 1)
    assert math.isclose(first["seen_hz"], 10)
    assert first["declared_hz"] == 10
    assert (second["epoch"], second["restart"], second["messages"]) == (2, 1, 1)


def swarm(patch: pytest.MonkeyPatch, *words: str | Path) -> int:
    """The exit code of the command."""
    patch.setattr(sys, "argv", ["swarm", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


def test_the_command_prints_a_table(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert swarm(monkeypatch, "analyze", run, "--no-samples") == 0
    shown = capsys.readouterr().out
    assert "no-imitation" in shown
    assert "report.md" in shown


def test_the_command_prints_one_json_object(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert swarm(monkeypatch, "analyze", run, "--no-samples", "--json") == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert result["conditions"]["imitation"]["trials"] == 3
    assert Path(result["files"]["curves.png"]).exists()
    assert "poses" not in result["files"]


@pytest.mark.parametrize("words", [["no.mcap"], ["missing"], ["."], []])
def test_a_bad_call_is_one_line_and_exit_code_2(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "no.mcap").write_bytes(b"no log at all")
    assert swarm(monkeypatch, "analyze", *[tmp_path / word for word in words]) == 2
    shown = capsys.readouterr()
    assert (shown.err.count("\n"), shown.out) == (1, "")
