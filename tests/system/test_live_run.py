"""Runs over plain publishing and subscribing: no lockstep, clocks instead."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from robot_agent.checkpoint import Checkpoint
from server.hubs.live import LiveHub
from swarm.clock import NS_PER_S, scaled_clock
from swarm.config.experiment import Experiment
from swarm.logs.check import check_log
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import Delivery, Topic, topic_of
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, learners, messages, run_server, write_experiment

SPEED = 20.0
STATE_EVERY_BATCHES = 5


def test_a_scaled_run_ends_with_every_move_in_the_log(tmp_path: Path) -> None:
    experiment = write_experiment(tmp_path, experiment_text(learners(2), moves=5))
    run = tmp_path / "run"
    result = run_server(experiment, run, "--speed", str(SPEED))
    log = run / "trial-000.mcap"
    for robot in ("r0", "r1"):
        numbers = [move.number for name, move in messages(log, "move") if name == robot]
        assert numbers[:5] == [1, 2, 3, 4, 5]
    assert result["moves"] >= 10
    assert check_log(log).faults == [], "every process has given account of what it sent"
    assert {state.phase for _, state in messages(log, "state")} >= {pb.RunState.RUNNING, pb.RunState.ENDED}


class LiveSwarm:
    """A hub in this process; the tracker bridge and the agent are processes of their own."""

    def __init__(self, directory: Path, stack: ExitStack, speed: float = SPEED) -> None:
        self._speed = speed
        self.file = write_experiment(directory, experiment_text(learners(1), moves=1000))
        self.directory = directory
        self.endpoint = free_endpoint()
        self._stack = stack
        self._started_ns = time.monotonic_ns()
        self.session = stack.enter_context(Session(SessionSettings(self.endpoint, hub=True)))
        claim(self.session, Presence("server", "server", "here", 1))
        clock = scaled_clock(self._started_ns, speed)
        self.processes: list[subprocess.Popen[bytes]] = []
        experiment = Experiment.load(self.file)
        self.identity = RunIdentity.of(experiment, 0, "0123456789ab")
        self.hub = LiveHub(self.session, clock, experiment, self.identity, self.check, print, epoch=1)
        self._batches = 0

    def start(self, module: str, *arguments: str, ahead_s: float = 0.0) -> subprocess.Popen[bytes]:
        """A process of the swarm, ended with the test, whose clock is so far ahead of the server's."""
        started_ns = self._started_ns - round(ahead_s / self._speed * NS_PER_S)
        pace = ("--started-ns", str(started_ns), "--speed", str(self._speed))
        command = [
            sys.executable,
            "-m",
            module,
            str(self.file),
            "--connect",
            self.endpoint,
            *pace,
            *arguments,
        ]
        process = self._stack.enter_context(subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE))
        self._stack.callback(process.kill)
        self.processes.append(process)
        return process

    def start_agent(self, ahead_s: float = 0.0) -> subprocess.Popen[bytes]:
        state = str(self.directory / "state")
        return self.start("robot_agent", "--robot", "r0", "--state", state, ahead_s=ahead_s)

    def check(self) -> None:
        """Nobody may die by itself."""
        for process in self.processes:
            assert process.poll() in (None, -signal.SIGKILL), process.args

    def items(self) -> Iterator[Item]:
        """What comes, for ever, while the run's state is announced."""
        while True:
            if self._batches % STATE_EVERY_BATCHES == 0:
                state = pb.RunState(phase=pb.RunState.RUNNING, run_id=self.identity.run_id)
                self.hub.publish(topics.RUN_STATE, state)
            self._batches += 1
            yield from self.hub.gather().items

    def received(self, topic: Topic[Any]) -> Iterator[tuple[Item, Any]]:
        """Decoded messages of one topic as they come."""
        for item in self.items():
            found = topic_of(item.key)
            if found and found[0] is topic:
                yield item, topic.message.FromString(item.payload)


@pytest.fixture
def swarm(tmp_path: Path) -> Iterator[LiveSwarm]:
    with ExitStack() as stack:
        yield LiveSwarm(tmp_path, stack)


def test_a_killed_agent_goes_on_from_its_checkpoint(swarm: LiveSwarm) -> None:
    swarm.start("tracker_bridge")
    agent = swarm.start_agent()
    first_epochs = set()
    for item, move in swarm.received(topics.MOVE):
        first_epochs.add(item.header.epoch)
        if move.number == 5:  # a move is told and then saved: the fifth shows that the fourth is
            break
    agent.kill()
    agent.wait()
    path = swarm.directory / "state" / "r0.json"
    identity = swarm.identity
    saved = Checkpoint(path.parent, "r0", identity.run_id, str(identity.fingerprint)).load()
    assert saved is not None
    moves_saved = saved.policy["moves"]
    assert moves_saved >= 4
    swarm.start_agent()
    item, move = next(
        found for found in swarm.received(topics.MOVE) if found[0].header.epoch not in first_epochs
    )
    assert move.number == moves_saved + 1, "it counts on"
    before = saved.policy["controller"]["q"][move.state][move.action]
    assert move.q_value - move.q_change == pytest.approx(before, abs=1e-12), "it learns on"
    assert item.header.sequence == 1, "a restart shows in the log as a new epoch that counts from 1"


def test_corrupt_messages_are_counted_and_nothing_dies(swarm: LiveSwarm) -> None:
    swarm.start("tracker_bridge")
    swarm.start_agent()
    with Session(SessionSettings(swarm.endpoint)) as stranger:
        pose = stranger.publisher(topics.POSE.key("r0"), Delivery.NEWEST)
        epoch = time.time_ns()
        for number, (_, status) in enumerate(swarm.received(topics.STATUS), 1):
            if status.bad_messages:
                break
            pose.put(b"no header")
            pose.put(b"\xff\xffgarbage", attachment=Header(epoch, 3 * number, 0).pack())
            pose.put(
                pb.Pose(x_m=float("nan")).SerializeToString(),
                attachment=Header(epoch, 3 * number + 1, 0).pack(),
            )
            pose.put(bytes(100_000), attachment=Header(epoch, 3 * number + 2, 0).pack())
    moves = swarm.received(topics.MOVE)
    numbers = [next(moves)[1].number for _ in range(5)]
    assert numbers == list(range(numbers[0], numbers[0] + 5)), "poses are still believed, and moves made"
    assert swarm.hub.without_header >= 1
    swarm.check()


@pytest.mark.parametrize(
    ("agent_ahead_s", "tracker_ahead_s"), [(3600.0, 0.0), (1.2, 0.0), (0.0, 3600.0), (0.0, -3.0)]
)
def test_robots_move_whatever_the_clocks_of_the_hosts_say(
    agent_ahead_s: float, tracker_ahead_s: float, tmp_path: Path
) -> None:
    """In real time, since what is tolerated is real time too."""
    with ExitStack() as stack:
        swarm = LiveSwarm(tmp_path, stack, speed=1.0)
        stack.callback(swarm.session.close)
        swarm.start("tracker_bridge", ahead_s=tracker_ahead_s)
        swarm.start_agent(agent_ahead_s)
        moves = swarm.received(topics.MOVE)
        numbers = [next(moves)[1].number for _ in range(3)]
    assert numbers == [1, 2, 3]
