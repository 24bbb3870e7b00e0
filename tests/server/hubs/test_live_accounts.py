"""The live hub at the end of a trial: what every sender has sent is known, by its own account."""

from __future__ import annotations

from pathlib import Path

from server.hubs.live import LiveHub
from swarm.clock import unix_clock
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim, present
from swarm.runtime.node import LiveNode
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import experiment_text, learners, write_experiment


def test_the_closing_account_of_each_process_comes_after_all_that_it_sent(tmp_path: Path) -> None:
    experiment = Experiment.load(write_experiment(tmp_path, experiment_text(learners(1), moves=1)))
    endpoint = free_endpoint()
    with (
        Session(SessionSettings(endpoint, hub=True)) as here,
        Session(SessionSettings(endpoint)) as there,
    ):
        identity = RunIdentity.of(experiment, 0, "0123456789ab")
        hub = LiveHub(here, unix_clock(), experiment, identity, lambda: None, print, epoch=1)
        claim(there, Presence("robot", "r0", "board", 77, str(identity.fingerprint)))
        node = LiveNode(there, unix_clock(), 0.01, epoch=77)
        while not present(here, "robot"):
            pass
        assert hub.accounts() == {}, "nobody has left"
        for number in range(1, 1001):
            node.publish(topics.MOVE, pb.Move(number=number), "r0")
        node.give_account("r0")
        last_words = hub.finish()
        hub.publish(topics.VIEW, pb.View(t_ns=1), "r0")
        hub.publish(topics.SERVER_EVENT, pb.Event(name="over"))
    numbers = [item.header.sequence for item in last_words.items if item.key == "robot/r0/move"]
    assert numbers == list(range(1, 1001))
    accounts = dict(hub.accounts())
    assert accounts.pop(("robot/r0/move", 77)) == 1000
    assert [(key, last) for (key, _), last in accounts.items()] == [("server/event", 1)], "no view is logged"
