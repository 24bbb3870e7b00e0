"""The conductor of a trial: it announces, follows and ends it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import Message

from server.conductor.carrier import SimulatedCarrier
from server.conductor.conductor import Conductor
from server.conductor.earlier import EarlierProgress
from server.hubs.hub import Batch
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.errors import RunFailedError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import Topic
from swarm.runtime.identity import RunIdentity
from tests.support.controls import control_of
from tests.support.swarm_runs import experiment_text, write_experiment

TICK_NS = NS_PER_S // 10


class Rig:
    """A conductor of three robots with 10 moves each, and what it says."""

    def __init__(self, directory: Path, earlier: Mapping[str, EarlierProgress] | None = None) -> None:
        self.said: list[tuple[str, Any]] = []
        experiment = Experiment.load(write_experiment(directory, experiment_text(moves=10)))
        reporter = Reporter(self)
        identity, carrier = RunIdentity.of(experiment, 3), SimulatedCarrier(reporter)
        self.control = control_of(experiment, reporter)
        self.conductor = Conductor(experiment, identity, reporter, carrier, self.control, earlier)
        self.t_ns = 0
        self._sequence = 0

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        self.said.append((topic.key(robot), message))

    def step(self, *heard: tuple[str, bytes]) -> list[Any]:
        """One tick with these messages; the run's states that it announces."""
        self.t_ns += TICK_NS
        before = len(self.said)
        items = []
        for key, payload in heard:
            self._sequence += 1
            items.append(Item(key, Header(1, self._sequence, self.t_ns), payload))
        self.conductor.step(Batch(self.t_ns, items))
        return [message for key, message in self.said[before:] if key == topics.RUN_STATE.key("")]


def move(robot: str, number: int) -> tuple[str, bytes]:
    return f"robot/{robot}/move", pb.Move(number=number, next_state=number).SerializeToString()


def status(robot: str, moves: int) -> tuple[str, bytes]:
    return f"robot/{robot}/status", pb.Status(activity="finished", moves=moves).SerializeToString()


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return Rig(tmp_path)


def test_the_state_is_announced_once_a_second(rig: Rig) -> None:
    announced = [rig.step() for _ in range(30)]
    assert [bool(states) for states in announced] == ([True] + [False] * 9) * 3
    state = announced[0][0]
    assert (state.phase, state.trial, state.experiment) == (pb.RunState.RUNNING, 3, "small")


def test_the_trial_ends_when_every_learner_has_made_its_moves(rig: Rig) -> None:
    """An expert goes on for ever: its moves end nothing, and are not waited for."""
    rig.step(move("expert", 500))
    rig.step(move("imitator", 10))
    assert not rig.conductor.ended
    states = rig.step(move("loner", 10))
    assert rig.conductor.ended
    assert [state.phase for state in states] == [pb.RunState.ENDED]
    assert rig.conductor.moves == {"expert": 500, "imitator": 10, "loner": 10}


def test_the_trial_ends_too_when_status_says_that_a_learner_has_made_its_moves(rig: Rig) -> None:
    """The last moves may have been made while no server was there to hear them."""
    rig.step(move("imitator", 10), move("loner", 7), status("expert", 999))
    assert not rig.conductor.ended
    rig.step(status("loner", 10))
    assert rig.conductor.ended


def test_it_goes_on_from_where_the_last_server_left_the_trial(tmp_path: Path) -> None:
    robots = {"imitator": EarlierProgress(moves=10), "loner": EarlierProgress(moves=9)}
    rig = Rig(tmp_path, robots)
    assert rig.conductor.moves == {"expert": 0, "imitator": 10, "loner": 9}
    rig.step(move("loner", 10))
    assert rig.conductor.ended


def test_best_paths_are_followed(rig: Rig) -> None:
    rig.step(("robot/loner/best_path", pb.BestPath(move=10, length=42, cap=100).SerializeToString()))
    assert rig.conductor.best_path == {"imitator": 0, "loner": 42}


def test_bad_and_unknown_messages_do_no_harm(rig: Rig) -> None:
    rig.step(("robot/loner/move", b"\xff\xffgarbage"), ("nobody/knows", b"x"), move("imitator", 1))
    assert rig.conductor.bad_messages == 1
    assert rig.conductor.moves["imitator"] == 1


def test_a_robot_that_stands_for_ever_ends_a_simulation_though_others_move(rig: Rig) -> None:
    rig.conductor.check_progress(rig.t_ns)
    rig.step(move("imitator", 10))
    rig.conductor.check_progress(rig.t_ns + 600 * NS_PER_S)
    rig.t_ns += 700 * NS_PER_S
    rig.step(move("expert", 1))
    with pytest.raises(RunFailedError, match=r"^loner: no move for 11 min of the run$"):
        rig.conductor.check_progress(rig.t_ns)


def test_people_are_told_once_of_a_robot_that_stands_and_again_after_it_moved(rig: Rig) -> None:
    assert rig.conductor.newly_standing(rig.t_ns) == []
    rig.t_ns += 700 * NS_PER_S
    rig.step(move("expert", 1), move("imitator", 1))
    assert rig.conductor.newly_standing(rig.t_ns) == ["loner: no move for 11 min of the run"]
    assert rig.conductor.newly_standing(rig.t_ns) == []
    rig.step(move("loner", 1))
    rig.t_ns += 700 * NS_PER_S
    assert len(rig.conductor.newly_standing(rig.t_ns)) == 3
    assert [message.name for key, message in rig.said if key == "server/event"] == ["stands"] * 4


def test_moves_made_before_the_server_was_started_again_count(rig: Rig) -> None:
    """A learner that has finished makes no move any more, but says once a second how many it made."""
    rig.step(("robot/loner/status", pb.Status(activity="finished", moves=10).SerializeToString()))
    assert not rig.conductor.ended
    rig.step(move("imitator", 10))
    assert rig.conductor.ended
