"""What is said of one moment of a small log."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.console.learner_view import observation_view
from swarm.console.moment import frame
from swarm.console.run_history import RunHistory
from swarm.messages import swarm_pb2 as pb
from tests.support.console_logs import history_of
from tests.support.learnt_logs import ROBOT, learnt_log
from tests.support.small_logs import TICK_NS, SmallLog, metadata
from tests.support.swarm_runs import ROOT, experiment_text, learners

FRAMES = 3
HALF_A_MOVE_S = 0.5
"""The log has a move a second."""


def small_log(path: Path) -> SmallLog:
    head = metadata(robots={"r0": "learner given", "r1": "learner given"})
    return SmallLog(path, {**head, "experiment": {"toml": experiment_text(learners(2))}})


def test_a_replay_is_shown_from_its_first_cell_and_ends_with_it(tmp_path: Path) -> None:
    """Every move says which path it belongs to: that is what is shown while the move is made."""
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 400)
    robot = (history := history_of(log)).robots[ROBOT]
    replayed = {
        number: replay
        for replay in robot.learning.replays
        for number in range(replay.started_move, replay.started_move + replay.moves)
    }
    assert len(replayed) > 20
    for move in robot.learning.moves:
        shown = frame(history, move.t_s - HALF_A_MOVE_S, 0.0)["robots"][ROBOT]["path"]
        replay = replayed.get(move.number)
        if replay is None:
            assert (shown["number"] if shown else 0) == move.path, "none, or one that a visit ended"
            continue
        assert shown["number"] == replay.path
        assert shown["done"] == move.number - replay.started_move
        first = robot.learning.moves[replay.started_move - 1]
        assert shown["from"] == first.state
        assert shown["moves"][0] == first.action


def test_a_pose_stands_where_it_was_captured_and_grows_old(tmp_path: Path) -> None:
    log = small_log(tmp_path / "trial-000.mcap")
    log.add("run/state", pb.RunState(phase=pb.RunState.RUNNING))
    for number in range(3):
        captured_t_ns = log.t_ns - 2 * TICK_NS
        log.add("robot/r0/pose", pb.Pose(x_m=0.1 * number, y_m=0.2, captured_t_ns=max(0, captured_t_ns)))
    for _ in range(20):
        log.add("run/state", pb.RunState(phase=pb.RunState.RUNNING))
    shown = frame(history_of(log.close()), 2.0, -1.0)
    assert shown["phase"] == "running"
    assert shown["robots"]["r0"]["pose"][:2] == [0.2, 0.2]
    assert shown["robots"]["r0"]["pose_age_s"] == pytest.approx(2.0, abs=0.11)
    assert [place[1:] for place in shown["robots"]["r0"]["trail"]][-1] == [0.2, 0.2]
    assert shown["robots"]["r1"]["pose"] is None


def test_lost_messages_are_counted_and_bad_ones_left_out(tmp_path: Path) -> None:
    log = small_log(tmp_path / "trial-000.mcap")
    for sequence in (1, 2, 5, 6):
        log.add("robot/r0/pose", pb.Pose(x_m=0.1), sequence=sequence)
    log.add("robot/r0/pose", pb.Pose(x_m=0.1), epoch=2, sequence=9)
    log.add("robot/r0/pose", b"\xff\xff\xff", epoch=2, sequence=10)
    history = history_of(log.close())
    assert history.robots["r0"].lost == 2, "3 and 4; another start of the tracker begins anew"
    assert history.bad_messages == 1


def test_the_time_left_is_that_of_the_slowest_learner(tmp_path: Path) -> None:
    log = small_log(tmp_path / "trial-000.mcap")
    for number in range(1, 21):
        log.add("robot/r0/move", pb.Move(number=number, state=0, action=0, next_state=1, duration_s=0.1))
        if number <= 10:
            log.add("robot/r1/move", pb.Move(number=number, state=0, action=0, next_state=1, duration_s=0.1))
    history = history_of(log.close())
    moves = history.experiment.run.moves
    assert moves == 100
    assert frame(history, 1.0, 0.0)["left_s"] is None, "nobody knows after five moves"
    assert frame(history, 2.9, 0.0)["left_s"] == pytest.approx((moves - 10) * 2.9 / 10)


def watching_log(path: Path) -> RunHistory:
    """A visit of a robot that saw the other one in two of three frames."""
    text = (ROOT / "deploy" / "sim" / "demo.toml").read_text()
    log = SmallLog(path, {**metadata(), "experiment": {"toml": text}})
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.READY))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.WATCHING))
    looks = []
    for number in range(FRAMES):
        log.add("robot/imitator/pose", pb.Pose(x_m=1.0, y_m=1.0, theta_rad=2.0))
        look = pb.Look(captured_t_ns=log.t_ns, frame_hash=number, not_seen="" if number else "dark")
        if number:
            look.range_m, look.bearing_rad, look.x_m, look.y_m = 0.5, 0.1, 0.7, 1.4
        looks.append(look)
    moves = [1, 1, 0]
    log.add("robot/imitator/observation", pb.Observation(visit=1, looks=looks, moves=moves, window=moves[:2]))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.DONE, path=1))
    log.add(
        "server/imitator/copy_error",
        pb.CopyError(visit=1, path=1, true_moves=[1, 1], copied_moves=[1, 1], edit_distance=0),
    )
    return history_of(log.close())


def test_a_visit_shows_each_frame_s_sighting(tmp_path: Path) -> None:
    history = watching_log(tmp_path / "trial-000.mcap")
    at = [frame(history, t_s, 0.0)["robots"]["imitator"]["visit"] for t_s in (0.05, 0.21, 0.31, 0.41, 0.61)]
    assert at[0]["phase"] == "ready"
    assert [each["sighting"] for each in at[1:4]] == [[], [0.5, 0.1], [0.5, 0.1]]
    assert at[4] is None


def test_an_observation_tells_frames_moves_and_what_was_really_done(tmp_path: Path) -> None:
    found = observation_view(watching_log(tmp_path / "trial-000.mcap"), "imitator", 1)
    assert found is not None
    assert [look["seen"] for look in found["looks"]] == [None, [0.7, 1.4], [0.7, 1.4]]
    assert found["looks"][0]["why_not"] == "dark"
    assert found["looks"][2]["hash"] == f"{2:016x}"
    assert found["moves"] == ["SE", "SE", "E"]
    assert found["window"] == found["true_moves"] == ["SE", "SE"]
    assert observation_view(watching_log(tmp_path / "trial-001.mcap"), "imitator", 2) is None
