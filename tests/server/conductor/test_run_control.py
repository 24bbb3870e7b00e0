"""What becomes of every order of an operator, and what the log says of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import Message

from server.conductor.carrier import Operator
from server.conductor.prompts import Prompts
from server.conductor.run_control import RunControl
from server.reporter import Reporter
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages.topics import Topic
from swarm.runtime.emergency_latch import EmergencyLatch

Order = pb.OperatorOrder
ROBOTS = ("a", "b")
PLACE = Pose(1.0, 1.0, 0.0)


class Rig:
    """A run with two robots, and everything that its server says."""

    def __init__(self, directory: Path) -> None:
        self.said: list[tuple[str, Any]] = []
        self.file = directory / "estop"
        self.prompts = Prompts()
        self.poses: dict[str, Pose] = {}
        self.control = self.restarted()

    def restarted(self) -> RunControl:
        """The control of a server that goes on with the run."""
        latch = EmergencyLatch(self.file)
        return RunControl(ROBOTS, Reporter(self), latch, self.prompts, self.poses.get)

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        self.said.append((topic.key(robot), message))

    def orders(self, kind: Order.Kind.ValueType, *robots: str, prompt: int = 0) -> pb.OrderAnswer:
        order = Order(kind=kind, operator="anna@lab", reason="why", robots=robots, prompt=prompt)
        return self.control.obey(order)

    def told(self) -> list[tuple[str, str]]:
        """What the robots were told since the last call."""
        orders = [
            (key, pb.Order.Kind.Name(message.kind)) for key, message in self.said if key.endswith("/order")
        ]
        self.said = [(key, message) for key, message in self.said if not key.endswith("/order")]
        return orders

    @property
    def phase(self) -> str:
        return pb.RunState.Phase.Name(self.control.phase)


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return Rig(tmp_path)


def test_pause_and_resume_change_the_phase_and_tell_no_robot_by_itself(rig: Rig) -> None:
    assert rig.phase == "RUNNING"
    assert rig.orders(Order.PAUSE).accepted
    assert (rig.phase, rig.control.reason) == ("PAUSED", "anna@lab (why)")
    assert not rig.orders(Order.PAUSE).accepted
    assert rig.orders(Order.RESUME).accepted
    assert (rig.phase, rig.control.reason) == ("RUNNING", "")
    assert not rig.orders(Order.RESUME).accepted
    assert rig.told() == []


def test_one_robot_is_paused_again_and_again_until_it_is_resumed(rig: Rig) -> None:
    assert rig.orders(Order.PAUSE, "b").accepted
    rig.control.repeat_pauses()
    assert rig.told() == [("robot/b/order", "PAUSE")] * 2
    assert rig.phase == "RUNNING"
    assert rig.orders(Order.RESUME, "a").text == "a: not paused"
    assert rig.orders(Order.RESUME, "b").accepted
    rig.control.repeat_pauses()
    assert rig.told() == [("robot/b/order", "RESUME")]


def test_a_robot_that_missed_its_resume_is_told_once_more(rig: Rig) -> None:
    rig.control.resumes("b", pb.Status(activity="deciding", paused=True))
    assert rig.told() == [("robot/b/order", "RESUME")]


def test_an_unknown_robot_is_refused_with_the_nearest_name(rig: Rig) -> None:
    assert rig.orders(Order.PAUSE, "bb").text == "no robot 'bb'; did you mean 'b'?"


@pytest.mark.parametrize("by_order", [True, False])
def test_an_emergency_outlives_the_server_and_is_released_into_a_pause(rig: Rig, by_order: bool) -> None:
    if by_order:
        rig.orders(Order.ESTOP)
    else:
        rig.control.emergency(pb.EmergencyStop(operator="anna@lab", reason="why"))
    assert rig.phase == "ESTOPPED"
    rig.control = rig.restarted()
    assert (rig.phase, rig.control.reason) == ("ESTOPPED", "anna@lab (why)")
    assert "release it first" in rig.orders(Order.RESUME).text
    assert rig.orders(Order.RELEASE).accepted
    assert rig.told() == [("robot/a/order", "RELEASE"), ("robot/b/order", "RELEASE")]
    assert rig.phase == "PAUSED"
    assert not rig.file.exists()
    assert rig.orders(Order.RESUME).accepted


def test_a_latch_is_in_force_whatever_stands_in_its_file(rig: Rig) -> None:
    rig.file.write_bytes(b"\xff\x00")
    rig.control = rig.restarted()
    assert rig.phase == "ESTOPPED"


def test_a_stopped_trial_has_ended(rig: Rig) -> None:
    assert rig.orders(Order.STOP).accepted
    assert (rig.phase, rig.control.stopped) == ("ENDED", "anna@lab (why)")


def test_a_person_is_asked_on_the_terminal_in_the_log_and_by_a_prompt(rig: Rig) -> None:
    shown: list[str] = []
    Operator(Reporter(rig), shown.append, rig.prompts).relocate("b", PLACE, "visit 1 to a")
    asked = "please carry b to x 1.00 m, y 1.00 m, heading 0.00 rad: visit 1 to a"
    assert shown == [f"{asked} (prompt 1)"]
    assert [message.text for key, message in rig.said if key == "server/event"] == [asked]
    ((prompt),) = rig.prompts.messages()
    assert (prompt.number, prompt.robot, prompt.text, prompt.x_m) == (1, "b", asked, 1.0)


def test_a_prompt_is_done_when_the_robot_s_own_pose_says_so(rig: Rig) -> None:
    number = rig.prompts.ask("b", PLACE, "please carry b")
    assert rig.orders(Order.DONE, prompt=number + 1).text == f"no prompt {number + 1} waits"
    rig.poses["b"] = Pose(1.3, 1.0, 0.0)
    refused = rig.orders(Order.DONE, prompt=number)
    assert refused.text == "b stands 0.30 m from there by its own pose, at x 1.30 m, y 1.00 m"
    assert [prompt.number for prompt in rig.prompts.messages()] == [number]
    rig.poses["b"] = Pose(1.02, 1.01, 0.0)
    assert rig.orders(Order.DONE, prompt=number).accepted
    assert list(rig.prompts.messages()) == []


def test_a_prompt_closes_by_itself_once_the_robot_stands_there(rig: Rig) -> None:
    rig.prompts.ask("b", PLACE, "please carry b")
    assert rig.prompts.look({"b": Pose(1.2, 1.0, 0.0)}, 1) == []
    (done,) = rig.prompts.look({"b": PLACE}, 2)
    assert done.robot == "b"
    assert list(rig.prompts.messages()) == []


def test_every_order_stands_in_the_log_and_every_refusal(rig: Rig) -> None:
    rig.orders(Order.PAUSE, "a")
    rig.orders(Order.RESUME)
    events = [message for key, message in rig.said if key == "server/event"]
    assert [(event.name, event.text) for event in events] == [
        ("order", "pause a by anna@lab (why): a will stand after the move or visit under way"),
        ("refused", "resume by anna@lab (why): the run is not paused"),
    ]


def test_what_a_person_says_stays_one_short_line(rig: Rig) -> None:
    answer = rig.control.obey(Order(kind=Order.PAUSE, operator="x\n" * 500, reason="y\n" * 5000))
    assert answer.accepted
    (event,) = (message for key, message in rig.said if key == "server/event")
    assert len(event.text) < 400
    assert "\n" not in event.text
