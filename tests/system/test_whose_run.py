"""Whose run is this? Nobody takes part in a run that is not theirs, and nothing enters its log."""

from __future__ import annotations

import json
import socket
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from swarm import open_run
from swarm.config.experiment import Experiment
from swarm.logs.check import check_run
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.messages.topics import Delivery
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.laboratory import Laboratory, line_of, quick_text
from tests.support.swarm_runs import messages, write_experiment
from tests.system.test_bad_input import refused


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[Laboratory]:
    """One learner with five moves to make."""
    with ExitStack() as stack:
        yield Laboratory(tmp_path, stack, moves=5)


def finished(server: subprocess.Popen[str]) -> str:
    """What a server that ended well has said."""
    _, said = server.communicate()
    assert server.returncode == 0, said
    return said


def events(log: Path, name: str) -> list[str]:
    """The texts of a log's events of one name."""
    return [event.text for _, event in messages(log, "event") if event.name == name]


def numbers(log: Path, robot: str) -> list[int]:
    """The numbers of a robot's moves, in the order of the log."""
    return [move.number for name, move in messages(log, "move") if name == robot]


def manifest(run: Path) -> Any:
    return json.loads((run / "manifest.json").read_text())


def test_a_run_has_an_id_in_its_files_its_log_and_its_state(laboratory: Laboratory) -> None:
    server = laboratory.serve()
    laboratory.track()
    agent = laboratory.agent("r0")
    finished(server)
    agent.communicate()
    assert agent.returncode == 0
    run = laboratory.directory / "run"
    run_id = manifest(run)["run_id"]
    states = [state for _, state in messages(run / "trial-000.mcap", "state")]
    identity = RunIdentity.of(Experiment.load(laboratory.file), 0, run_id)
    assert len(run_id) == 12
    assert {state.run_id for state in states} == {run_id}
    assert {state.identity for state in states} == {str(identity.fingerprint)}
    assert json.loads((run / "run.json").read_text())["run_id"] == run_id
    assert numbers(run / "trial-000.mcap", "r0")[:5] == [1, 2, 3, 4, 5]


def test_another_experiment_is_refused_with_the_keys_and_its_robot_leaves(
    laboratory: Laboratory, tmp_path: Path
) -> None:
    text = quick_text(1, moves=5).replace("epsilon = 1.0", "epsilon = 0.9").replace('"small"', '"other"')
    other = write_experiment(tmp_path / "other", text)
    server = laboratory.serve()
    laboratory.track()
    line = line_of(laboratory.agent("r0", "--seed", 7, file=other), 2)
    assert "learning.epsilon is 0.9 here and 1.0 there" in line
    assert 'run.name is "other" here and "small" there' in line
    assert "run.seed is 7 here and 1 there" in line
    laboratory.agent("r0")
    said = finished(server)
    refusal = "does not take part: its experiment has other settings, its seed is 7 and not 1"
    assert said.count(refusal) == 1
    log = laboratory.directory / "run" / "trial-000.mcap"
    assert [text for text in events(log, "refused") if refusal in text]
    assert numbers(log, "r0")[:5] == [1, 2, 3, 4, 5]


def test_what_the_server_s_command_line_changes_is_known_to_the_agents(laboratory: Laboratory) -> None:
    laboratory.serve("--moves", 7, "--trial", 2)
    line = line_of(laboratory.agent("r0"), 2)
    assert "run.moves is 5 here and 7 there, --trial is 0 here and 2 there" in line
    line = line_of(laboratory.track(), 2)
    assert "run.moves is 5 here and 7 there, --trial is 0 here and 2 there" in line


def test_a_robot_that_the_experiment_does_not_name_is_no_part_of_the_run(laboratory: Laboratory) -> None:
    """One that is honest leaves; one that claims to be of the run is left out, whatever it says."""
    server = laboratory.serve()
    laboratory.track()
    two = write_experiment(laboratory.directory / "two", quick_text(2, moves=5))
    assert "robot.r1 is only here" in line_of(laboratory.agent("r1", file=two), 2)
    identity = RunIdentity.of(Experiment.load(laboratory.file), 0)
    with Session(SessionSettings(laboratory.endpoint)) as stranger:
        claim(stranger, Presence("robot", "ghost", "nowhere", 77, str(identity.fingerprint)))
        for sequence, name in enumerate(("ghost", "r0"), 1):
            move = pb.Move(number=1000, duration_s=1.0).SerializeToString()
            header = Header(77, sequence, 0).pack()
            stranger.publisher(topics.MOVE.key(name), Delivery.EVERY).put(move, attachment=header)
        laboratory.agent("r0")
        said = finished(server)
    assert "robot 'ghost' on host 'nowhere' does not take part: the experiment does not name it" in said
    assert "messages of robot/r0/move from nobody who takes part (epoch 77) are left out" in said
    log = laboratory.directory / "run" / "trial-000.mcap"
    assert {name for name, _ in messages(log, "move")} == {"r0"}
    assert numbers(log, "r0")[:5] == [1, 2, 3, 4, 5], "the false move 1000 did not end the trial"


def test_what_one_run_taught_enters_another_only_if_a_person_says_so(laboratory: Laboratory) -> None:
    first, second, third = (laboratory.directory / name for name in ("first", "second", "third"))
    server = laboratory.serve("--out", first)
    tracker, agent = laboratory.track(), laboratory.agent("r0")
    finished(server)
    agent.wait()
    tracker.wait()

    server = laboratory.serve("--out", second)
    tracker = laboratory.track()
    line = line_of(laboratory.agent("r0"), 2)
    assert f"r0.json: what was learnt in run {manifest(first)['run_id']} (" in line
    assert f"this is run {manifest(second)['run_id']}: --fresh begins anew and keeps the file" in line
    agent = laboratory.agent("r0", "--fresh")
    finished(server)
    agent.wait()
    tracker.wait()
    assert numbers(second / "trial-000.mcap", "r0")[:5] == [1, 2, 3, 4, 5]
    assert (laboratory.directory / "state" / f"r0.{manifest(first)['run_id']}.json").exists()

    server = laboratory.serve("--out", third)
    laboratory.track()
    _, said = laboratory.agent("r0", "--resume").communicate()
    text = f"from what it learnt in another run, {manifest(second)['run_id']}"
    assert text in said
    finished(server)
    assert [event for event in events(third / "trial-000.mcap", "resumed") if text in event]


def test_an_agent_of_the_same_run_goes_on_after_its_battery_was_changed(laboratory: Laboratory) -> None:
    server = laboratory.serve()
    laboratory.track()
    agent = laboratory.agent("r0")
    laboratory.wait_for_moves("r0", 2)
    agent.kill()
    agent.wait()
    _, said = laboratory.agent("r0", "--fresh").communicate()
    assert "from what it learnt in this run" in said, "--fresh is about other runs"
    finished(server)
    log = laboratory.directory / "run" / "trial-000.mcap"
    assert set(numbers(log, "r0")) >= {1, 2, 3, 4, 5}
    assert [text for text in events(log, "resumed") if "in this run" in text]


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[Laboratory]:
    """Two learners with many moves to make, under way."""
    with ExitStack() as stack:
        yield Laboratory(tmp_path, stack, count=2, moves=30)


def killed_server_of(pair: Laboratory, after: int) -> list[subprocess.Popen[str]]:
    """The tracker and the agents of a server that was killed after so many moves."""
    server = pair.serve()
    others = [pair.track(), *(pair.agent(robot) for robot in ("r0", "r1"))]
    pair.wait_for_moves("r0", after)
    server.kill()
    server.wait()
    return others


def test_an_agent_that_hears_of_another_run_stops_and_says_why(pair: Laboratory) -> None:
    tracker, *agents = killed_server_of(pair, after=1)
    pair.serve("--out", pair.directory / "second")
    runs = [manifest(pair.directory / "run")["run_id"]]
    for process in (tracker, *agents):
        line = line_of(process, 1)
        runs += [manifest(pair.directory / "second")["run_id"]]
        assert f"another run ({runs[-1]}), and this process takes part in run {runs[0]}" in line


def test_a_server_goes_on_with_the_run_of_one_that_was_killed(pair: Laboratory) -> None:
    run = pair.directory / "run"
    _, *agents = killed_server_of(pair, after=12)
    finished(pair.serve("--resume", run))
    for agent in agents:
        agent.communicate()
        assert agent.returncode == 0
    assert manifest(run)["trials"][0]["state"] == "complete"
    assert len(json.loads((run / "run.json").read_text())["log"]) == 2
    moves = open_run(run).table("moves").collect()
    for robot in ("r0", "r1"):
        made = moves.filter(robot=robot)["number"]
        assert made.n_unique() == len(made), "no move is there twice"
    assert moves["log"].unique().to_list() == [str(run / "trial-000.mcap")]
    (found,) = check_run(run)
    for robot, count in moves.group_by("robot").len().iter_rows():
        last = moves.filter(robot=robot)["sequence"].max()
        missing = f"robot/{robot}/move: {last - count} messages missing"
        assert (missing in found.faults) == (last > count), "what nobody heard is missing, and named"


def test_a_learner_s_last_moves_are_heard_although_no_server_was_there(tmp_path: Path) -> None:
    """The learner makes its last moves after the server was killed."""
    with ExitStack() as stack:
        laboratory = Laboratory(tmp_path, stack, moves=12)
        server, agent, _ = laboratory.serve(), laboratory.agent("r0"), laboratory.track()
        laboratory.wait_for_moves("r0", 9)
        server.kill()
        server.wait()
        checkpoint = tmp_path / "state" / "r0.json"
        while json.loads(checkpoint.read_text())["policy"]["moves"] < 12:
            assert agent.poll() is None
        finished(laboratory.serve("--resume", tmp_path / "run"))
        agent.communicate()
        assert agent.returncode == 0
    run = tmp_path / "run"
    made = [number for log in sorted(run.glob("*.mcap"), reverse=True) for number in numbers(log, "r0")]
    assert made == list(range(1, 13))
    print(check_run(run))
    assert check_run(run)[0].faults == []


def test_a_running_trial_is_untouched_by_who_comes_too_late(pair: Laboratory) -> None:
    """A second server at its place or for its directory, a second agent of one id: each leaves."""
    server = pair.serve()
    pair.track()
    pair.agent("r0")
    pair.agent("r1")
    pair.wait_for_moves("r0", 1)
    run = pair.directory / "run"
    before = (run / "manifest.json").read_bytes()
    second = pair.serve("--out", pair.directory / "second")
    assert f"cannot listen on {pair.endpoint}: is another server running there" in line_of(second, 2)
    line = line_of(pair.agent("r0"), 2)
    host = socket.gethostname()
    assert f"'r0' is already alive on host {host!r}; this one on host {host!r} does not start" in line
    assert "(started twice there, or a copied card?)" in line
    pair.endpoint = free_endpoint()
    assert f"{run}: a server is recording there now" in line_of(pair.serve("--resume", run), 2)
    assert (run / "manifest.json").read_bytes() == before
    assert server.poll() is None
    finished(server)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--resume", "no-run", "--listen", "tcp/127.0.0.1:0"), "no-run: has no manifest.json"),
        (("--resume", "no-run"), "no-run: has no manifest.json"),
        (("--resume", "no-run", "--speed", "2"), "leave out speed"),
        (("--resume", "no-run", "--seed", "0"), "leave out seed"),
        ((), "EXPERIMENT.toml is missing"),
    ],
)
def test_what_cannot_be_resumed_is_refused(options: tuple[str, ...], reason: str) -> None:
    assert reason in refused("server", *options)


def test_a_trial_that_ended_is_not_resumed(laboratory: Laboratory) -> None:
    server = laboratory.serve()
    laboratory.track()
    laboratory.agent("r0")
    finished(server)
    line = line_of(laboratory.serve("--resume", laboratory.directory / "run"), 2)
    assert "all trials of the run are complete; there is nothing to resume" in line
