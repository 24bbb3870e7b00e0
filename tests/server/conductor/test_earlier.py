"""How far a trial was is read off the logs that its servers left."""

from __future__ import annotations

from pathlib import Path

from server.conductor.earlier import EarlierProgress, earlier_progress
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog, metadata


def test_what_each_robot_did_adds_up_over_the_logs(tmp_path: Path) -> None:
    first, second = SmallLog(tmp_path / "trial-000.mcap"), SmallLog(tmp_path / "trial-000-2.mcap", metadata())
    first.add("robot/imitator/order", pb.Order(kind=pb.Order.WATCH, visit=1))
    first.add("robot/imitator/path", pb.PathRemembered(path=1, moves=[1], source="camera", visit=1))
    first.add("robot/imitator/path", pb.PathRemembered(path=2, moves=[1], source="given"))
    first.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.DONE))
    first.add("robot/imitator/move", pb.Move(number=1, track=1))
    first.add("robot/imitator/move", b"\xff\xff")
    second.add("robot/imitator/order", pb.Order(kind=pb.Order.WATCH, visit=2))
    second.add("robot/imitator/visit", pb.Visit(visit=2, phase=pb.Visit.READY))
    second.add("robot/imitator/move", pb.Move(number=15, track=4))
    second.add("robot/loner/move", pb.Move(number=2, track=1))
    found = earlier_progress([first.close(), second.close()])
    assert found == {
        "imitator": EarlierProgress(moves=15, tracks=3, copied_paths=1, visits=2, visits_over=1),
        "loner": EarlierProgress(moves=2),
    }


def test_a_log_of_which_nothing_can_be_read_tells_nothing(tmp_path: Path) -> None:
    empty = SmallLog(tmp_path / "trial-000.mcap").close()
    assert earlier_progress([empty]) == {}
