"""`swarm export`: what other programs read of a log is what the log says."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from rosbags.highlevel import AnyReader
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.errors import UserError
from swarm.logs.export import Format, export_log
from swarm.logs.reader import LogError
from swarm.logs.rosbag2 import ros_topic
from tests.conftest import SmallRun
from tests.support.small_logs import learning_log
from tests.support.swarm_runs import ROOT, messages

POSE = "geometry_msgs/msg/PoseStamped"


def test_a_bag_holds_every_message_in_time(small_run: SmallRun, tmp_path: Path) -> None:
    export_log(small_run.log, Format.ROSBAG2, tmp_path / "bag")
    with AnyReader([tmp_path / "bag"]) as bag:
        found: list[tuple[Any, int, Any]] = [
            (line, t_ns, bag.deserialize(data, line.msgtype)) for line, t_ns, data in bag.messages()
        ]
    assert all(before <= after for (_, before, _), (_, after, _) in pairwise(found))
    counts = Counter(line.topic for line, *_ in found)
    for kind in ("move", "pose", "status", "truth"):
        expected = Counter(robot for robot, _ in messages(small_run.log, kind))
        where = "sim" if kind == "truth" else "robot"
        assert expected == {robot: counts[f"/{where}/{robot}/{kind}"] for robot in expected}
    poses = [one for line, _, one in found if line.topic == "/robot/loner/pose"]
    for (_, ours), theirs in zip(
        (each for each in messages(small_run.log, "pose") if each[0] == "loner"), poses, strict=True
    ):
        check_pose(ours, theirs)
    moves = [json.loads(one.data) for line, _, one in found if line.topic == "/robot/loner/move"]
    durations = [move.duration_s for robot, move in messages(small_run.log, "move") if robot == "loner"]
    assert [move["duration_s"] for move in moves] == durations


def check_pose(ours: Any, theirs: Any) -> None:
    turn = theirs.pose.orientation
    assert theirs.__msgtype__ == POSE
    assert theirs.header.stamp.sec * 10**9 + theirs.header.stamp.nanosec == ours.captured_t_ns
    assert (theirs.pose.position.x, theirs.pose.position.y) == (ours.x_m, ours.y_m)
    assert math.cos(2 * math.atan2(turn.z, turn.w) - ours.theta_rad) == pytest.approx(1)


def test_csv_and_parquet_are_the_same_tables(small_run: SmallRun, tmp_path: Path) -> None:
    tables = {path.stem: path for path in export_log(small_run.log, Format.PARQUET, tmp_path / "parquet")}
    texts = {path.stem: path for path in export_log(small_run.log, Format.CSV, tmp_path / "csv")}
    assert tables.keys() == texts.keys() >= {"moves", "poses", "paths", "health"}
    assert not list((tmp_path / "csv").glob("*.parquet"))
    moves = list(csv.DictReader(texts["moves"].read_text().splitlines()))
    assert [float(row["q_value"]) for row in moves] == pl.read_parquet(tables["moves"])["q_value"].to_list()
    paths = list(csv.DictReader(texts["paths"].read_text().splitlines()))
    assert [row["moves"] for row in paths] == ["SE SE SE SE SE"]


def test_a_key_is_a_name_in_ros() -> None:
    assert ros_topic("robot/e-puck-7/pose") == "/robot/e_puck_7/pose"


def test_the_command_makes_a_folder_once(tmp_path: Path) -> None:
    log = learning_log(tmp_path / "trial-000.mcap", {"loner": [30, 20]})
    done = CliRunner().invoke(app, ["export", str(log), "--to", "csv", "--json"])
    assert done.exit_code == 0
    assert all(Path(file).is_file() for file in json.loads(done.stdout)["files"])
    with pytest.raises(UserError, match="exists already"):
        export_log(log, Format.PARQUET, tmp_path / "trial-000-csv")


def test_a_log_of_another_program_is_refused_before_anything_is_made(tmp_path: Path) -> None:
    foreign = ROOT / "tests" / "data" / "mcap" / "clean.mcap"
    for to in Format:
        with pytest.raises(LogError, match="which run and trial"):
            export_log(foreign, to, tmp_path / "out")
    assert not (tmp_path / "out").exists()
