"""The agent's loop with a simulated body, tracker and bridge, all in one process."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robot_agent.activities import Finished, Moving
from robot_agent.assembly import Assembly, Place
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from tests.support.local_node import LocalNode
from tests.support.swarm_runs import experiment_text, learners, write_experiment
from tracker_bridge.backends.sim import SimulatedTracker
from tracker_bridge.bridge import Bridge
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

TICK_NS = NS_PER_S // 10


class Rig:
    """One learner at work; the test is its conductor."""

    def __init__(
        self, directory: Path, moves: int = 1000, *, watches: bool = False, without_server: str = "wait"
    ) -> None:
        text = experiment_text(learners(1), moves)
        text = text.replace("[arena]", f'without_server = "{without_server}"\n[arena]')
        experiment = Experiment.load(write_experiment(directory, text))
        if watches:
            (robot,) = experiment.robot
            experiment = replace(experiment, robot=(replace(robot, watches="r0"),))
        self.node = LocalNode()
        self._assembly = Assembly(experiment, self.node, 0, Place(state=directory))
        self.agent = self._assembly.agent("r0")
        self.compartment = experiment.compartment(experiment.robot[0])
        truths = self.node.subscribe(topics.TRUTH)
        tracker = SimulatedTracker(experiment.tracker, truths.take, lambda _: np.random.default_rng(1))
        self._bridge = Bridge(tracker, Plausibility(PlausibilitySettings(13.0, 1.3)), self.node, ["r0"])

    def restart(self) -> None:
        """A new process in place of the agent's, with what the old one has kept."""
        self.agent = self._assembly.agent("r0")

    def run(
        self,
        seconds: float,
        phase: pb.RunState.Phase.ValueType | None = pb.RunState.RUNNING,
        *,
        tracked: bool = True,
    ) -> list[tuple[str, Any]]:
        """Let time pass; what the robot published."""
        before = len(self.node.published)
        for _ in range(round(10 * seconds)):
            self.node.t_ns += TICK_NS
            self.node.publish(topics.VIEW, pb.View(t_ns=self.node.t_ns), "r0")
            if phase is not None:
                self.node.publish(topics.RUN_STATE, pb.RunState(phase=phase))
            self.agent.step(self.node.t_ns)
            self.agent.keep_emergency()
            if tracked:
                self._bridge.step(self.node.t_ns)
        return [
            (key, message) for key, message in self.node.published[before:] if key.startswith("robot/r0/")
        ]

    def order(self, kind: pb.Order.Kind.ValueType, x_m: float = 0.0, y_m: float = 0.0) -> None:
        self.node.publish(topics.ORDER, pb.Order(kind=kind, visit=1, x_m=x_m, y_m=y_m), "r0")


def of(published: list[tuple[str, Any]], name: str) -> list[Any]:
    return [message for key, message in published if key == f"robot/r0/{name}"]


def stands(published: list[tuple[str, Any]]) -> bool:
    """Whether the last commands stopped the wheels."""
    return all(
        command.left_steps_per_s == command.right_steps_per_s == 0.0
        for command in of(published, "command")[-5:]
    )


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return Rig(tmp_path)


def test_it_waits_for_the_run(rig: Rig) -> None:
    published = rig.run(10, pb.RunState.PREPARING)
    assert of(published, "move") == []
    assert stands(published)


def test_its_moves_follow_each_other_through_the_grid(rig: Rig) -> None:
    moves = of(rig.run(120), "move")
    assert len(moves) > 30
    for sooner, later in pairwise(moves):
        assert later.state == sooner.next_state
        assert later.number == sooner.number + 1
    for move in moves:
        entered = rig.compartment.grid.neighbour(move.state, move.action)
        assert move.blocked == (entered is None)
        assert move.next_state == (move.state if entered is None else entered)


def test_a_pause_lets_it_finish_its_move_and_it_goes_on_when_told(rig: Rig) -> None:
    before = of(rig.run(30), "move")[-1].number
    rig.order(pb.Order.PAUSE)
    paused = rig.run(30)
    assert len(of(paused, "move")) <= 1
    assert stands(paused)
    assert of(paused, "status")[-1].paused
    rig.order(pb.Order.RESUME)
    numbers = [move.number for move in of(rig.run(30), "move")]
    assert numbers[0] - before <= 2
    assert len(numbers) > 5


def test_a_visit_ordered_meanwhile_does_not_end_a_pause(rig: Rig) -> None:
    rig.order(pb.Order.PAUSE)
    rig.order(pb.Order.RUN)
    assert of(rig.run(20), "move") == []


def test_an_emergency_stops_it_in_mid_move_until_it_is_released(rig: Rig) -> None:
    rig.run(30)
    while stands(rig.run(0.1)):
        pass
    rig.node.publish(topics.ESTOP, pb.EmergencyStop(operator="anna@lab"))
    stopped = rig.run(20)
    assert stands(stopped[:5]), "within the first tick, whatever the run's state says"
    assert of(stopped, "move") == []
    assert (of(stopped, "status")[-1].activity, of(stopped, "status")[-1].estopped) == ("estopped", True)
    rig.order(pb.Order.RUN)
    rig.order(pb.Order.RESUME)
    assert of(rig.run(10), "move") == [], "no other order releases it"
    rig.order(pb.Order.RELEASE)
    assert of(rig.run(10, pb.RunState.PAUSED), "move") == []
    assert len(of(rig.run(30), "move")) > 5


def test_an_emergency_that_only_the_server_tells_of_stops_it_too(rig: Rig) -> None:
    rig.run(30)
    assert stands(rig.run(2, pb.RunState.ESTOPPED))
    assert of(rig.run(10), "move") == [], "the run's state alone does not release it"


def test_an_emergency_outlives_the_agent(rig: Rig) -> None:
    rig.run(30)
    rig.node.publish(topics.ESTOP, pb.EmergencyStop(operator="anna@lab", reason="a hand"))
    rig.run(1)
    rig.restart()
    stopped = rig.run(10)
    assert stands(stopped)
    assert of(stopped, "move") == []
    (event,) = of(stopped, "event")
    assert event.text == "emergency stop by anna@lab (a hand): the wheels stand until it is released"
    rig.order(pb.Order.RELEASE)
    rig.run(1)
    rig.restart()
    assert len(of(rig.run(60), "move")) > 5


def test_a_move_that_an_emergency_ended_is_told_of_by_its_cell(rig: Rig) -> None:
    """Whoever replays the log has to know of a choice that came to nothing."""
    rig.run(30)
    while not isinstance(rig.agent.activity, Moving):
        rig.run(0.1)
    state = rig.agent.activity.state
    rig.node.publish(topics.ESTOP, pb.EmergencyStop(operator="anna@lab"))
    (event,) = of(rig.run(1), "event")
    assert event.text.endswith(f"; the move from cell {state} is not learnt from")


def test_its_wheels_stand_while_it_hears_nothing_new(rig: Rig) -> None:
    rig.run(30)
    rig.node.behind_s = 0.26
    deaf = rig.run(3)
    assert stands(deaf[:5])
    assert of(deaf, "move") == []
    rig.node.behind_s = 0.0
    assert stands(rig.run(1, None)), "until it has heard that there is no emergency"
    assert len(of(rig.run(30), "move")) > 5


def test_its_wheels_stand_after_a_lost_connection_until_it_hears_the_run_s_state(rig: Rig) -> None:
    """An emergency stop that was sent meanwhile never comes."""
    rig.run(30)
    rig.node.losses += 1
    assert stands(rig.run(1, None))
    assert len(of(rig.run(30), "move")) > 5


def test_without_a_server_it_gives_its_move_up_if_the_experiment_says_so(tmp_path: Path) -> None:
    rig = Rig(tmp_path, without_server="stop")
    rig.run(30)
    while not isinstance(rig.agent.activity, Moving):
        rig.run(0.1)
    rig.node.behind_s = 1.0
    silent = rig.run(5.2, None)
    assert stands(silent)
    assert of(silent, "move") == []
    assert [event.name for event in of(silent, "event")] == ["server_lost"]
    rig.node.behind_s = 0.0
    assert len(of(rig.run(30), "move")) > 5


def test_it_tells_when_it_stands_for_a_pause_and_when_it_may_go_on(rig: Rig) -> None:
    rig.run(30)
    paused = rig.run(10, pb.RunState.PAUSED)
    assert [event.text for event in of(paused, "event")] == ["stands: the run is paused"]
    assert [event.name for event in of(rig.run(1), "event")] == ["resumed"]


def test_it_stands_when_the_conductor_falls_silent(rig: Rig) -> None:
    rig.run(30)
    rig.run(10, None)
    silent = rig.run(30, None)
    assert of(silent, "move") == []
    assert stands(silent)


def test_it_stands_without_poses_and_goes_on_with_them(rig: Rig) -> None:
    rig.run(30)
    rig.run(10, tracked=False)
    blind = rig.run(20, tracked=False)
    assert stands(blind)
    assert of(blind, "status")[-1].pose_age_s > 20
    assert len(of(rig.run(60), "move")) > 5


def test_the_end_of_the_trial_stops_it(rig: Rig) -> None:
    rig.run(31)
    ended = rig.run(5, pb.RunState.ENDED)
    assert stands(ended)
    assert of(ended, "move") == []


def test_the_end_of_the_trial_stops_a_visit_too(tmp_path: Path) -> None:
    """It watches from where it stands, sees nobody, and turns to look for the demonstrator."""
    rig = Rig(tmp_path, watches=True)
    rig.run(2, pb.RunState.PREPARING)
    rig.order(pb.Order.WATCH, *rig.compartment.centre(0))
    watching = rig.run(5)
    assert [visit.phase for visit in of(watching, "visit")] == [pb.Visit.READY, pb.Visit.WATCHING]
    assert of(watching, "status")[-1].activity == "visiting"
    assert not stands(watching)
    ended = rig.run(5, pb.RunState.ENDED)
    assert stands(ended)
    assert of(ended, "visit") == []
    assert of(ended, "status")[-1].activity == "waiting"


def test_it_finishes_after_its_moves(tmp_path: Path) -> None:
    rig = Rig(tmp_path, moves=7)
    published = rig.run(60)
    assert [move.number for move in of(published, "move")] == list(range(1, 8))
    assert isinstance(rig.agent.activity, Finished)
    assert stands(published)


def test_a_robot_that_is_carried_away_learns_nothing_from_it(rig: Rig) -> None:
    rig.run(30)
    state = 55
    x_m, y_m = rig.compartment.centre(state)
    rig.node.publish(topics.CARRY, pb.Carry(x_m=x_m, y_m=y_m, theta_rad=1.0), "r0")
    carried = rig.run(60)
    assert [event.name for event in of(carried, "event")] == ["displaced"]
    moves = of(carried, "move")
    first_after = next(later for sooner, later in pairwise(moves) if later.state != sooner.next_state)
    assert first_after.state == state
    assert all(
        move.next_state == move.state
        or rig.compartment.grid.neighbour(move.state, move.action) == move.next_state
        for move in moves
    )
