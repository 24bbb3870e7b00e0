"""Where people ask and order, over a real session: what is no order is answered, too."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import Message

from server.conductor.carrier import SimulatedCarrier
from server.conductor.conductor import Conductor
from server.conductor.prompts import Prompts
from server.conductor.run_control import RunControl
from server.control.desk import Desk
from server.control.status_board import StatusBoard
from server.hubs.hub import Batch
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from swarm.messages.topics import ESTOP, OPERATOR_ORDER, Topic
from swarm.runtime.emergency_latch import EmergencyLatch
from swarm.runtime.identity import RunIdentity
from swarm.runtime.operating import ask_status, send_order, status_as_json
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import experiment_text, learners, write_experiment


class Rig:
    """A server's desk that serves all the time, and somebody's session."""

    def __init__(self, directory: Path, stack: ExitStack) -> None:
        endpoint = free_endpoint()
        hub = stack.enter_context(Session(SessionSettings(endpoint, hub=True)))
        experiment = Experiment.load(write_experiment(directory, experiment_text(learners(2))))
        identity, reporter, prompts = RunIdentity.of(experiment, 0, "0123456789ab"), Reporter(self), Prompts()
        board = StatusBoard(experiment, identity, prompts, lambda: [])
        self.control = RunControl(["r0", "r1"], reporter, EmergencyLatch(None), prompts, board.pose_of)
        conductor = Conductor(experiment, identity, reporter, SimulatedCarrier(reporter), self.control)
        self._desk = Desk(hub, self.control, board, prompts, conductor, reporter)
        self._over = threading.Event()
        self._to_hear: list[Item] = []
        serving = threading.Thread(target=self._serve)
        serving.start()
        stack.callback(serving.join)
        stack.callback(self._over.set)
        self.session = stack.enter_context(Session(SessionSettings(endpoint)))

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        """The server says something; nobody listens."""

    def hears(self, key: str, message: Message) -> None:
        """A message is in the next batch."""
        self._to_hear.append(Item(key, Header(1, len(self._to_hear) + 1, 0), message.SerializeToString()))

    def _serve(self) -> None:
        t_ns = 0
        while not self._over.is_set():
            t_ns += NS_PER_S // 10
            heard, self._to_hear = self._to_hear, []
            self._desk.step(Batch(t_ns, heard))


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


@pytest.mark.parametrize(("payload", "says"), [(b"", "says nothing"), (b"\xff\xff", "no OperatorOrder")])
def test_what_is_no_order_is_refused_with_the_reason(rig: Rig, payload: bytes, says: str) -> None:
    (answer,) = rig.session.ask(OPERATOR_ORDER, 5.0, payload)
    refused = pb.OrderAnswer.FromString(answer)
    assert not refused.accepted
    assert says in refused.text


def test_an_order_is_carried_out_and_shows_in_the_status(rig: Rig) -> None:
    order = pb.OperatorOrder(kind=pb.OperatorOrder.PAUSE, operator="anna@lab", robots=["r1"])
    assert send_order(rig.session, order).accepted
    assert [robot.paused for robot in ask_status(rig.session).robots] == [False, True]


def test_the_status_tells_what_was_heard_of_each_robot(rig: Rig) -> None:
    rig.hears("robot/r0/status", pb.Status(activity="moving", battery_v=3.9, pose_age_s=0.1))
    rig.hears("robot/r0/command", pb.Command(x_m=1.0, y_m=2.0))
    rig.hears("robot/r0/event", pb.Event(level=pb.Event.WARNING, name="link", text="slow"))
    while not (status := ask_status(rig.session)).events:
        pass
    heard, silent = status.robots
    assert (heard.activity, heard.battery_v, heard.has_pose, heard.x_m) == ("moving", 3.9, True, 1.0)
    assert (silent.activity, silent.has_pose, silent.heard_age_s) == ("", False, 1e5)
    assert [(event.sender, event.name) for event in status.events] == [("r0", "link")]
    told = status_as_json(status)
    assert (told["phase"], told["robots"][1]["moves"], told["prompts"]) == ("RUNNING", 0, [])


def test_an_emergency_that_is_overheard_stops_the_run(rig: Rig) -> None:
    rig.hears(ESTOP.key(""), pb.EmergencyStop(operator="anna@lab"))
    while ask_status(rig.session).phase != pb.RunState.ESTOPPED:
        pass
    assert rig.control.reason == "emergency stop by anna@lab"
