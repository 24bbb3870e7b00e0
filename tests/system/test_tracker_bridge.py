"""The `tracker-bridge` command with real processes, sockets and Zenoh."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.natnet_capture import NATNET
from tests.support.swarm_runs import ROOT, experiment_text, server_command, write_experiment
from tests.support.tracked_swarm import LOOPBACK, free_udp_port

COMMAND = [sys.executable, "-m", "tracker_bridge"]


def called(*words: object, asked: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, words)], cwd=ROOT, capture_output=True, text=True, check=False, input=asked
    )


def started(*words: object) -> subprocess.Popen[bytes]:
    return subprocess.Popen([*COMMAND, *map(str, words)], cwd=ROOT)


@pytest.fixture(params=["vicon", "natnet"])
def experiment(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Three robots, and a tracking system whose y is up."""
    table = f'[tracker]\nbackend = "{request.param}"\nserver = "{LOOPBACK}"\ninterface = "{LOOPBACK}"\n'
    table += f'port = {free_udp_port()}\ncommand_port = {free_udp_port()}\naxes = "x -z y"\nturn_rad = 0.3\n'
    return write_experiment(tmp_path, experiment_text(extra=table))


def system_of(experiment: Path) -> str:
    return "vicon" if '"vicon"' in experiment.read_text() else "natnet"


def test_check_sees_an_emulated_swarm(experiment: Path) -> None:
    with started("emulate", system_of(experiment), experiment) as emulator:
        report: dict[str, Any] = {"missing": True}
        while report["missing"]:
            result = called("check", experiment, "--seconds", 2, "--json")
            report = json.loads(result.stdout)
        emulator.terminate()
    assert result.returncode == 0
    assert {robot["robot"] for robot in report["robots"]} == {"expert", "imitator", "loner"}
    assert report["mistakes"] == []
    assert report["refused"] == {}


def test_check_fails_in_one_line_if_nobody_is_seen(experiment: Path) -> None:
    result = called("check", experiment, "--seconds", 0.2)
    assert result.returncode == 1
    assert result.stderr == "failed: not seen: expert, imitator, loner\n"


def test_watch_shows_a_table_the_arena_and_the_tracks(experiment: Path, tmp_path: Path) -> None:
    picture = tmp_path / "tracks.png"
    with started("emulate", system_of(experiment), experiment) as emulator:
        result = called("watch", experiment, "--times", 3, "--every", 1, "--picture", picture)
        emulator.terminate()
    assert result.returncode == 0
    assert result.stdout.count("latency ms p50") == 3
    last = result.stdout.split("latency ms p50")[-1]
    assert all(robot in last for robot in ("expert", "imitator", "loner", "+----"))
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_poses_of_an_emulated_swarm_reach_the_swarm(experiment: Path) -> None:
    endpoint = free_endpoint()
    seen: dict[str, pb.Pose] = {}
    identity = RunIdentity.of(Experiment.load(experiment), 0, "a run")
    with Session(SessionSettings(endpoint, hub=True)) as session:
        session.answer(topics.RUN_IDENTITY, identity.pack())
        inbox = session.inbox(topics.POSE.key(), topics.POSE.delivery, keep_all=True)
        with (
            started("emulate", system_of(experiment), experiment) as emulator,
            started(experiment, "--connect", endpoint) as bridge,
        ):
            while len(seen) < 3:
                assert bridge.poll() is None, "it left"
                seen |= {sample.key: pb.Pose.FromString(sample.payload) for sample in inbox.poll()}
            bridge.terminate()
            emulator.terminate()
    assert set(seen) == {f"robot/{robot}/pose" for robot in ("expert", "imitator", "loner")}
    for pose in seen.values():
        assert 0 <= pose.received_t_ns - pose.captured_t_ns < 10**9
        assert 0 <= pose.y_m <= 1.3


def test_a_robot_learns_by_poses_from_an_emulated_system(experiment: Path, tmp_path: Path) -> None:
    """The whole chain in real time: the truth becomes the system's bytes, and those a robot's pose."""
    file, endpoint = experiment, free_endpoint()
    common = ["--connect", endpoint, "--moves", "3"]
    server = subprocess.Popen(
        [*server_command(file, tmp_path / "log"), "--listen", endpoint, "--moves", "3"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
    )
    robots = [
        subprocess.Popen([sys.executable, "-m", "robot_agent", file, *common, "--robot", robot], cwd=ROOT)
        for robot in ("expert", "imitator", "loner")
    ]
    others = [
        started(file, *common),
        started("emulate", system_of(file), file, "--connect", endpoint),
    ]
    output, _ = server.communicate()
    for process in (*robots, *others):
        process.terminate()
        process.wait()
    assert server.returncode == 0
    assert json.loads(output)["moves"] >= 6


def test_places_are_asked_for_one_after_the_other(tmp_path: Path) -> None:
    """A recording in which the body stands still: every place is then seen alike, which cannot fit."""
    rows = "".join(
        f"{number},2024-10-31T16:26:{number:02d}Z,{100 * (number % 2)},50,0\n" for number in range(9)
    )
    recording = tmp_path / "standing.csv"
    recording.write_text(",timestamp,expert_x,expert_y,expert_z\n" + rows)
    file = write_experiment(
        tmp_path, experiment_text(extra=f'[tracker]\nbackend = "replay"\nfile = "{recording}"\n')
    )
    corners = [word for place in ("0,0", "2,0", "2,2") for word in ("--at", place)]
    result = called("calibrate", file, "--body", "expert", *corners, "--seconds", 2, asked="\n\n\n")
    assert result.returncode == 2
    assert result.stdout.count("Put expert at") == 3
    assert result.stderr.startswith("error: one unit of the system would be")


def test_points_from_a_file_give_the_lines_of_the_table(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("100,80,-200,0.2,0.3\n2100,80,-200,2.2,0.3\n2100,80,-2200,2.2,2.3\n")
    result = called("calibrate", write_experiment(tmp_path, experiment_text()), "--points", points)
    assert result.returncode == 0
    assert result.stdout.startswith('axes = "x -z y"\nunit_m = 0.001\norigin_m = [0.1000, 0.1000]\n')


@pytest.mark.parametrize(("name", "version", "body"), [("1.7.2-001", "2.7", 1), ("1.9.0-001", "2.9", 2)])
def test_decode_prints_bodies_markers_and_what_is_left(name: str, version: str, body: int) -> None:
    result = called("decode", "natnet", NATNET / f"frame-motive-{name}.bin", "--version", version, "--json")
    packet = json.loads(result.stdout)
    assert packet["bytes_left"] == 0
    assert [each["id"] for each in packet["bodies"]] == [body]
    assert len(packet["markers"]) == 3


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["decode", "natnet", "none.bin"], "none.bin: No such file or directory"),
        (["decode", "natnet", NATNET / "README.md"], "no natnet packet"),
        (["decode", "natnet", NATNET / "modeldef_packet_v3.bin", "--version", "9.9"], "versions 2.5 to 4.1"),
        (["check", "none.toml"], "none.toml: there is no such file"),
        (["emulate", "optitrak", "x.toml"], "invalid choice"),
        (["calibrate", "none.toml", "--points", "none.csv"], "none.csv: No such file"),
    ],
)
def test_errors_are_one_line(words: list[object], said: str) -> None:
    result = called(*words)
    assert result.returncode == 2
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
