"""`swarm-server --live`, looked at with a plain WebSocket client that knows Foxglove's protocol."""

from __future__ import annotations

import json
import signal
import socket
import struct
import subprocess
import sys
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from server.recording.live_viewers import MOST_WAITING, live_viewers
from swarm.errors import UserError
from swarm.messages import topics
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import (
    ROOT,
    experiment_text,
    learners,
    run_server,
    server_command,
    write_experiment,
)
from tests.support.waiting import until

PROTOCOL = Subprotocol("foxglove.sdk.v1")
MESSAGE_DATA = struct.Struct("<BIQ")
"""Opcode 1, subscription, log time in ns; the payload follows."""
WANTED = ("view/arena", "view/robots", "robot/r0/move")


class Viewer:
    """What Foxglove's application does: hear of channels, subscribe, decode by the channel's own schema."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self.channels: dict[str, dict[str, Any]] = {}

    def subscribe(self, *wanted: str) -> None:
        """Once all of them have been advertised."""
        while not self.channels.keys() >= set(wanted):
            said = self._connection.recv()
            assert isinstance(said, str), "nobody has subscribed yet"
            for channel in json.loads(said).get("channels", ()):
                self.channels[channel["topic"]] = channel
        numbers = [self.channels[topic]["id"] for topic in wanted]
        asked = [{"id": number, "channelId": number} for number in numbers]
        self._connection.send(json.dumps({"op": "subscribe", "subscriptions": asked}))

    def received(self) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time and payload of what comes."""
        topic_of = {channel["id"]: topic for topic, channel in self.channels.items()}
        for said in self._connection:
            if isinstance(said, bytes):
                opcode, number, t_ns = MESSAGE_DATA.unpack_from(said)
                assert opcode == 1
                yield topic_of[number], t_ns, said[MESSAGE_DATA.size :]

    def decoded(self, topic: str, payload: bytes) -> Any:
        """By the schema that the channel was advertised with, and nothing else."""
        channel = self.channels[topic]
        assert (channel["encoding"], channel["schemaEncoding"]) == ("protobuf", "protobuf")
        pool = DescriptorPool()
        for file in FileDescriptorSet.FromString(b64decode(channel["schema"])).file:
            pool.Add(file)  # type: ignore[no-untyped-call, unused-ignore]
        return GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"])).FromString(payload)


@contextmanager
def viewing(address: str) -> Iterator[Viewer]:
    with connect(f"ws://{address}", subprotocols=[PROTOCOL], open_timeout=None) as connection:
        assert connection.subprotocol == PROTOCOL
        yield Viewer(connection)


@pytest.fixture
def address() -> str:
    """HOST:PORT that is free on this machine."""
    return free_endpoint().partition("/")[2]


def is_served(address: str) -> bool:
    host, _, port = address.rpartition(":")
    with socket.socket() as probe:
        return probe.connect_ex((host, int(port))) == 0


def test_a_viewer_sees_the_run_while_it_goes_on(tmp_path: Path, address: str) -> None:
    experiment = write_experiment(tmp_path, experiment_text(learners(2), moves=1000))
    command = server_command(experiment, tmp_path / "run", "--speed", "20", "--live", address)
    with subprocess.Popen(command, cwd=ROOT) as server:
        try:
            until(lambda: is_served(address))
            seen = what_a_viewer_sees(address)
        finally:
            server.send_signal(signal.SIGTERM)
    assert {robot.id for robot in seen["view/arena"].entities} == {"r0", "r1"}
    assert seen["view/robots"].frame_id == seen["view/arena"].entities[0].frame_id
    assert seen["robot/r0/move"].number >= 1


def what_a_viewer_sees(address: str) -> dict[str, Any]:
    """The first message of each topic that is wanted, asked for when the run is well under way."""
    seen: dict[str, Any] = {}
    with viewing(address) as viewer:
        viewer.subscribe(*WANTED)
        for topic, t_ns, payload in viewer.received():
            assert t_ns > 0
            seen.setdefault(topic, viewer.decoded(topic, payload))
            if seen.keys() >= set(WANTED):
                break
    return seen


def test_what_is_shown_leaves_the_log_as_it_is(tmp_path: Path, address: str) -> None:
    experiment = write_experiment(tmp_path, experiment_text(learners(1), moves=3))
    shown = run_server(experiment, tmp_path / "shown", "--live", address)
    assert shown["digest"] == run_server(experiment, tmp_path / "alone")["digest"]


def test_a_viewer_that_does_not_read_misses_something_and_holds_nobody_up(address: str) -> None:
    """40 MB are more than sockets hold; to write them ends although nobody reads."""
    arena = SceneUpdate()
    arena.entities.add(id="r" * 10_000)
    sent = 4 * MOST_WAITING
    with live_viewers(address, insecure=False) as viewers, viewing(address) as viewer:
        viewers.write_view(topics.VIEW_ARENA, arena, 1)
        viewer.subscribe(topics.VIEW_ARENA)
        received = viewer.received()
        assert next(received)[1] == 1, "the arena comes to whoever is late"
        for t_ns in range(2, sent + 1):
            viewers.write_view(topics.VIEW_ARENA, arena, t_ns)
        times_ns = [1]
        while times_ns[-1] < sent:
            times_ns.append(next(received)[1])
    assert times_ns == sorted(set(times_ns))
    assert MOST_WAITING <= len(times_ns) < sent


def test_others_do_not_look_on_unless_they_may(address: str) -> None:
    everywhere = address.replace("127.0.0.1", "0.0.0.0")
    with pytest.raises(UserError, match="--insecure"), live_viewers(everywhere, insecure=False):
        pass


def refused(tmp_path: Path, *options: str, before: str = "pass") -> str:
    """The one line of a server that does not begin."""
    experiment = write_experiment(tmp_path, experiment_text(learners(1), moves=3))
    program = f"import sys; {before}; from server.main import main; main()"
    command = [sys.executable, "-c", program, str(experiment), "--out", str(tmp_path / "run"), *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert not (tmp_path / "run").exists()
    return done.stderr


def test_a_port_in_use_is_said(tmp_path: Path, address: str) -> None:
    with live_viewers(address, insecure=False):
        assert f"--live {address}: " in (line := refused(tmp_path, "--live", address))
    assert "already in use" in line


def test_what_is_no_address_of_this_machine_is_said(tmp_path: Path) -> None:
    assert "'127.0.0.1:99999' is no HOST:PORT" in refused(tmp_path, "--live", "127.0.0.1:99999")
    elsewhere = "192.0.2.1:8765"
    assert f"--live {elsewhere}: " in refused(tmp_path, "--insecure", "--live", elsewhere)


def test_the_extra_is_named_if_it_is_missing(tmp_path: Path) -> None:
    line = refused(tmp_path, "--live", before="sys.modules['foxglove'] = None")
    assert "pip install 'swarm-runtime[live]'" in line
