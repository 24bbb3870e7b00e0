"""What a console says of a learner, against the learner itself, which `swarm replay` feeds once more."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import pytest

from swarm.console.learner_view import learner_view
from swarm.console.learning_history import MOVES_BETWEEN_TABLES
from swarm.replay.replay import Request, moment, replay_log
from tests.support.console_logs import history_of
from tests.support.learnt_logs import ROBOT, LearningRobot, learnt_log

MOVES = 2 * MOVES_BETWEEN_TABLES + 100


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("learnt") / "trial-000.mcap"
    learnt_log(path, MOVES)
    return path


@pytest.mark.parametrize("move", [1, 40, MOVES_BETWEEN_TABLES - 1, MOVES_BETWEEN_TABLES, 417, MOVES])
def test_table_and_memory_are_those_of_the_learner_after_any_move(log: Path, move: int) -> None:
    history = history_of(log)
    learning = history.robots[ROBOT].learning
    told = learning.time_of_move(move)
    assert told is not None
    assert learning.made(told) == move
    learner = moment(replay_log(Request((log,), at=move)).replays[ROBOT].learner)
    assert list(learning.q_table(move)) == list(chain.from_iterable(learner["q_table"]))
    shown = learner_view(history, ROBOT, told)["memory"]
    for ours, theirs in zip(shown, learner["memory"], strict=True):
        assert "-".join(ours["moves"]) == theirs["moves"]
        for name in ("replayed", "completed", "improved"):
            assert ours[name] == theirs[name], name
        assert ours["ratio"] == pytest.approx(theirs["ratio"], abs=1e-4)
        assert ours["p_imitate"] == pytest.approx(theirs["p_imitate"], abs=1e-4)


def test_a_robot_that_goes_on_from_a_checkpoint_has_what_it_had_then(tmp_path: Path) -> None:
    """Its last three moves were told, and not saved: they are made again, otherwise."""
    robot = LearningRobot(tmp_path / "trial-000.mcap")
    robot.move(297)
    saved, state = robot.policy.snapshot(), robot.state
    robot.move(3)
    robot.start(saved)
    robot.state = state
    robot.move(20)
    history = history_of(robot.close())
    learning = history.robots[ROBOT].learning
    assert len(learning.moves) == 320
    assert learning.last_number == 317
    expected = list(chain.from_iterable(robot.policy.snapshot()["controller"]["q"]))
    assert list(learning.q_table(320)) == expected
    assert learning.time_of_move(298) == learning.moves[300].t_s, "the later of the two"


def test_a_robot_that_begins_anew_knows_nothing(tmp_path: Path) -> None:
    robot = LearningRobot(tmp_path / "trial-000.mcap")
    robot.move(60)
    robot.start()
    learning = history_of(robot.close()).robots[ROBOT].learning
    assert any(learning.q_table(60))
    robot = LearningRobot(tmp_path / "trial-001.mcap")
    robot.move(60)
    robot.start()
    robot.state = 0
    robot.move(1)
    learning = history_of(robot.close()).robots[ROBOT].learning
    assert not any(learning.q_table(61))
    assert learning.last_number == 1
    assert learning.time_of_move(2) is None
