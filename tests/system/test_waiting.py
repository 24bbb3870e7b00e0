"""Agents and bridges that wait for a server: what they say, and that they leave when they are told to."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from server.hubs.live import LiveHub
from swarm.clock import unix_clock
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, write_experiment

RUN_ID = "0123456789ab"
COMMANDS = {"robot_agent": ("--robot", "r0"), "tracker_bridge": ()}


class Waiter:
    """An agent or a bridge as its user starts it, read line by line."""

    def __init__(self, module: str, experiment: Path, endpoint: str, stack: ExitStack) -> None:
        words = [sys.executable, "-m", module, str(experiment), "--connect", endpoint, *COMMANDS[module]]
        self.process = stack.enter_context(
            subprocess.Popen(words, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        )
        stack.callback(self.process.kill)

    def next_line(self) -> str:
        assert self.process.stderr
        return self.process.stderr.readline().rstrip()

    def rest(self) -> str:
        return self.process.communicate()[1]


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def experiment(tmp_path: Path) -> Path:
    return write_experiment(tmp_path, experiment_text(learners(1)))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("module", COMMANDS)
def test_one_that_waits_for_a_server_says_so_and_leaves_when_told(
    module: str, number: signal.Signals, experiment: Path, stack: ExitStack
) -> None:
    endpoint = free_endpoint()
    waiter = Waiter(module, experiment, endpoint, stack)
    assert waiter.next_line() == f"waiting for the server at {endpoint}"
    waiter.process.send_signal(number)
    assert waiter.rest() == ""
    assert waiter.process.returncode == 128 + number


@pytest.mark.parametrize(
    "endpoint", ["http/127.0.0.1:80", "tcp/127.0.0.1:99999", "tcp/no-such-host.invalid:1"]
)
@pytest.mark.parametrize("module", COMMANDS)
def test_an_endpoint_that_cannot_be_is_refused_at_once(
    module: str, endpoint: str, experiment: Path, stack: ExitStack
) -> None:
    waiter = Waiter(module, experiment, endpoint, stack)
    lines = waiter.rest().splitlines()
    assert len(lines) == 1
    assert lines[0].startswith(f"error: {endpoint}: ")
    assert waiter.process.returncode == 2


class Server:
    """The hub of a laboratory at an endpoint, which can go away and come back."""

    def __init__(self, endpoint: str, experiment: Path, epoch: int) -> None:
        self._session = Session(SessionSettings(endpoint, hub=True))
        claim(self._session, Presence("server", "server", "here", epoch))
        settings = Experiment.load(experiment)
        identity = RunIdentity.of(settings, 0, RUN_ID)
        self.hub = LiveHub(
            self._session,
            unix_clock(),
            settings,
            identity,
            lambda: None,
            lambda line: None,  # noqa: ARG005
            epoch,
        )

    def wait_for(self, key: str) -> None:
        while key not in {item.key for item in self.hub.gather().items}:
            pass

    def close(self) -> None:
        self._session.close()


def test_every_change_of_the_connection_is_one_line(experiment: Path, stack: ExitStack) -> None:
    endpoint = free_endpoint()
    agent = Waiter("robot_agent", experiment, endpoint, stack)
    assert agent.next_line() == f"waiting for the server at {endpoint}"
    server = Server(endpoint, experiment, epoch=2)
    assert agent.next_line() == f"connected to the server at {endpoint}"
    server.wait_for("robot/r0/status")
    server.close()
    assert agent.next_line() == "lost the server: waiting for it"
    server = Server(endpoint, experiment, epoch=1)
    assert agent.next_line() == "resumed: the server is back"
    server.wait_for("robot/r0/status")
    while agent.process.poll() is None:
        server.hub.publish(topics.RUN_STATE, pb.RunState(phase=pb.RunState.ENDED, run_id=RUN_ID))
        server.hub.gather()
    assert agent.rest() == "finished: the run has ended\n"
    assert agent.process.returncode == 0
    server.close()
