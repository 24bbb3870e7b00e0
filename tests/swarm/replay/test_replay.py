"""`swarm replay`: what the learner decides from a log is what it decided, or where it is not."""

from __future__ import annotations

import csv
import json
import math
from itertools import count
from pathlib import Path

import pytest
from google.protobuf.message import Message
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.errors import RunFailedError, UserError
from swarm.messages import swarm_pb2 as pb
from swarm.replay.changes import changes_of
from swarm.replay.replay import LogReplay, Request, moment, replay_log
from tests.conftest import SmallRun
from tests.support.learnt_logs import ROBOT, LearningRobot, learnt_log, rewritten

MOVES = 1200


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, LearningRobot]:
    """A log with replays of every outcome, and the robot that made it."""
    log = tmp_path_factory.mktemp("learnt") / "trial-000.mcap"
    return log, learnt_log(log, MOVES)


def check_identical(found: LogReplay, moves: int) -> None:
    assert found.is_identical, found.as_json()
    assert sum(each.moves for each in found.replays.values()) == moves
    assert found.recording.remarks == []


def test_a_simulated_run_replays_bit_for_bit(small_run: SmallRun) -> None:
    check_identical(replay_log(Request((small_run.log,))), 60)


def test_a_long_log_with_visits_replays_bit_for_bit(learnt: tuple[Path, LearningRobot]) -> None:
    log, robot = learnt
    found = replay_log(Request((log,)))
    check_identical(found, MOVES)
    assert moment(found.replays[ROBOT].learner)["q_table"] == robot.policy.snapshot()["controller"]["q"]
    outcomes = {
        message.outcome
        for messages in found.recording.learning[ROBOT].results.values()
        for message in messages
        if isinstance(message, pb.Replay)
    }
    assert outcomes == {"completed", "rejected", "blocked", "goal"}


def test_a_changed_rule_is_caught_at_the_first_move_that_differs(
    learnt: tuple[Path, LearningRobot], tmp_path: Path
) -> None:
    """The same robot with that rule, in a log of its own, says which move that is."""
    log, robot = learnt
    other = learnt_log(tmp_path / "other.mcap", 120, beta=0.2)
    pairs = zip(count(1), robot.actions, other.actions, strict=False)
    expected = next(number for number, here, there in pairs if here != there)
    replay = replay_log(Request((log,), changes={"beta": 0.2})).replays[ROBOT]
    assert replay.diverged is not None
    assert (replay.diverged.move, replay.moves) == (expected, expected - 1)
    assert replay.q_values_that_differ is None


def test_a_discount_shows_in_a_value_before_it_shows_in_a_decision(
    learnt: tuple[Path, LearningRobot],
) -> None:
    replay = replay_log(Request((learnt[0],), changes={"discount_rate_per_s": 0.3})).replays[ROBOT]
    assert replay.first is not None
    assert replay.first.what == "q_value"
    assert replay.diverged is None or replay.diverged.move > replay.first.move


def test_without_a_path_the_others_keep_their_numbers(learnt: tuple[Path, LearningRobot]) -> None:
    log, _ = learnt
    replay = replay_log(Request((log,), without=(2,))).replays[ROBOT]
    assert replay.diverged is not None
    assert replay.diverged.move > 40, "path 2 was remembered after move 40"
    at = replay_log(Request((log,), at=replay.diverged.move - 1, without=(2,))).replays[ROBOT]
    assert [each["path"] for each in moment(at.learner)["memory"]] == [1]
    with pytest.raises(UserError, match="no path 77"):
        replay_log(Request((log,), without=(77,)))


@pytest.mark.parametrize("field", ["q_value", "q_change"])
def test_the_last_bit_of_a_value_shows(
    learnt: tuple[Path, LearningRobot], tmp_path: Path, field: str
) -> None:
    def change(message: Message) -> Message:
        if isinstance(message, pb.Move) and message.number == 777:
            setattr(message, field, math.nextafter(getattr(message, field), 1))
        return message

    replay = replay_log(Request((rewritten(learnt[0], tmp_path / "l.mcap", change),))).replays[ROBOT]
    assert replay.first is not None
    assert (replay.first.move, replay.first.what) == (777, field)
    assert replay.moves == MOVES, "no decision differs"


@pytest.mark.parametrize("kind", [pb.Replay, pb.BestPath])
def test_every_replay_and_best_path_is_compared(
    learnt: tuple[Path, LearningRobot], tmp_path: Path, kind: type[Message]
) -> None:
    left = count(1)

    def change(message: Message) -> Message | None:
        """Leaves out the third of its kind."""
        return None if isinstance(message, kind) and next(left) == 3 else message

    assert not replay_log(Request((rewritten(learnt[0], tmp_path / "l.mcap", change),))).is_identical


def test_a_missing_move_ends_the_replay(learnt: tuple[Path, LearningRobot], tmp_path: Path) -> None:
    def change(message: Message) -> Message | None:
        return None if isinstance(message, pb.Move) and message.number == 50 else message

    replay = replay_log(Request((rewritten(learnt[0], tmp_path / "l.mcap", change),))).replays[ROBOT]
    assert replay.diverged is not None
    assert (replay.diverged.what, replay.diverged.recorded) == ("number", 51)
    assert replay.moves == 49


@pytest.mark.parametrize("killed", [False, True])
def test_a_robot_that_was_carried_away_in_the_middle_of_a_move(tmp_path: Path, killed: bool) -> None:
    """The log does not say whether it had decided; what it decided afterwards does, also after a restart."""
    robot = LearningRobot(tmp_path / "l.mcap")
    for _ in range(20):
        robot.move(7)
        robot.give_up_a_move()
        robot.move(3)
        if killed:
            robot.start(robot.policy.snapshot())
        robot.carried_away()
    check_identical(replay_log(Request((robot.close(),))), 200)


def test_a_robot_goes_on_from_its_checkpoint(tmp_path: Path) -> None:
    """Killed in a move, killed before the last move was saved, and killed after a path was remembered."""
    robot = LearningRobot(tmp_path / "l.mcap")
    robot.move(23)
    saved, state = robot.policy.snapshot(), robot.state
    robot.policy.choose(robot.state)
    robot.start(saved)
    robot.move(11)
    saved, state = robot.policy.snapshot(), robot.state
    robot.move()
    robot.start(saved)
    robot.state = state
    robot.move(30)
    saved = robot.policy.snapshot()
    robot.visit("E", "S")
    robot.start(saved)
    robot.move(30)
    found = replay_log(Request((robot.close(),)))
    check_identical(found, 94)
    assert len(found.recording.learning[ROBOT].first_moves()) == 4


def test_a_moment_is_what_the_robot_had_in_its_head(tmp_path: Path) -> None:
    robot = LearningRobot(tmp_path / "l.mcap")
    robot.move(90)
    robot.visit("SE", "E")
    robot.move(10)
    then = robot.policy.snapshot()["controller"]
    robot.move(100)
    log = robot.close()
    learner = replay_log(Request((log,), at=100)).replays[ROBOT].learner
    assert learner.snapshot()["controller"] == then
    assert [path["moves"] for path in moment(learner)["memory"]] == ["SE-SE-SE-SE-SE", "SE-E"]
    with pytest.raises(UserError, match="the log has 200 moves"):
        replay_log(Request((log,), at=201))


def test_the_command_writes_the_table_and_its_map(learnt: tuple[Path, LearningRobot], tmp_path: Path) -> None:
    log, _ = learnt
    done = CliRunner().invoke(
        app, ["replay", str(log), "--at", "500", "--out", str(tmp_path / "q"), "--json"]
    )
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    table, picture = map(Path, told["files"])
    assert picture.read_bytes().startswith(b"\x89PNG")
    rows = list(csv.reader(table.read_text().splitlines()))
    q = [[float(value) for value in row[3:]] for row in rows[1:]]
    assert q == told["robots"][ROBOT]["at"]["q_table"]


def test_the_command_fails_where_the_log_is_not_what_the_learner_does(
    learnt: tuple[Path, LearningRobot], tmp_path: Path
) -> None:
    def change(message: Message) -> Message:
        if isinstance(message, pb.Move) and message.number == 3:
            message.action = (message.action + 1) % 8
        return message

    log = rewritten(learnt[0], tmp_path / "l.mcap", change)
    done = CliRunner().invoke(app, ["replay", str(log), "--json"])
    assert isinstance(done.exception, RunFailedError)
    assert "move 3, action" in str(done.exception)
    assert json.loads(done.stdout)["robots"][ROBOT]["moves"] == 2
    changed = CliRunner().invoke(app, ["replay", str(log), "--with", "beta=0.3"])
    assert changed.exit_code == 0
    assert "from move" in changed.stdout


def test_bad_calls_say_what_is_known(learnt: tuple[Path, LearningRobot]) -> None:
    log, _ = learnt
    for texts, reason in ((["beta"], "NAME=VALUE"), (["bet=1"], "did you mean 'beta'")):
        with pytest.raises(UserError, match=reason):
            changes_of(texts)
    with pytest.raises(UserError, match="at least 0 and at most"):
        replay_log(Request((log,), changes=changes_of(["beta=3"])))
    with pytest.raises(UserError, match="no learner 'imitater'; did you mean 'imitator'"):
        replay_log(Request((log,), robot="imitater"))
