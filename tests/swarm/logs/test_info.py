"""What `swarm info` says of a log, against the `mcap` package's own reader."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.errors import UserError
from swarm.logs.info import CLOSED, DAMAGED, OPEN, LogInfo, logs_named, read_info
from swarm.logs.reader import LogError
from tests.support.small_logs import learning_log
from tests.support.swarm_runs import ROOT

FOREIGN = ROOT / "tests" / "data" / "mcap"
BY_INDEX = ("clean", "clean-lz4", "clean-zstd", "faults", "unchunked")
BY_SCAN = {"no-crc": CLOSED, "truncated": OPEN}
UNREADABLE = ("malformed", "unsupported-codec")


def theirs(path: Path) -> tuple[Counter[str], dict[str, str], list[int]]:
    """Messages and schema of each topic, and all log times, up to where the `mcap` package can read."""
    counts: Counter[str] = Counter()
    schemas: dict[str, str] = {}
    times: list[int] = []
    with path.open("rb") as file:
        try:
            for schema, channel, one in NonSeekingReader(file).iter_messages(log_time_order=False):
                counts[channel.topic] += 1
                schemas[channel.topic] = schema.name if schema else ""
                times.append(one.log_time)
        except McapError:
            pass
    return counts, schemas, times


def check_against_theirs(info: LogInfo) -> None:
    counts, schemas, times = theirs(info.path)
    assert {name: topic.messages for name, topic in info.topics.items() if topic.messages} == counts
    assert {name: topic.schema for name, topic in info.topics.items() if topic.messages} == schemas
    assert (info.start_t_ns, info.end_t_ns, info.messages) == (min(times), max(times), len(times))


@pytest.mark.parametrize("name", [*BY_INDEX, *BY_SCAN])
def test_logs_of_others_are_told_as_the_mcap_package_reads_them(name: str) -> None:
    info = read_info(FOREIGN / f"{name}.mcap")
    check_against_theirs(info)
    assert info.by_index == (name in BY_INDEX)
    assert info.state == BY_SCAN.get(name, CLOSED)
    assert info.run is None


@pytest.mark.parametrize("name", UNREADABLE)
def test_what_cannot_be_read_is_refused_with_a_reason(name: str) -> None:
    with pytest.raises(LogError, match=name):
        read_info(FOREIGN / f"{name}.mcap")


def log_in(folder: Path, trial: int = 0) -> Path:
    return learning_log(
        folder / f"trial-{trial:03}.mcap", {"loner": [30, 20, 12], "imitator": [25, 14]}, trial
    )


def test_a_log_of_ours_says_which_trial_it_is_and_how_that_ended(tmp_path: Path) -> None:
    info = read_info(log_in(tmp_path, trial=2))
    check_against_theirs(info)
    assert info.run is not None
    assert (info.run["name"], info.run["seed"], info.run["trial"]) == ("small", 1, 2)
    assert info.trial_ended == {"state": "complete", "reason": ""}
    assert info.rate_hz("robot/loner/best_path") == pytest.approx(3 / info.duration_s)


def test_an_index_alone_is_enough(tmp_path: Path) -> None:
    """Nothing of the messages is read: they may be all zeros, and the answer is the same."""
    log = log_in(tmp_path)
    before, data = read_info(log), bytearray(log.read_bytes())
    place = data.index(b"\x28\xb5\x2f\xfd")  # where a zstd frame begins: a chunk's contents
    data[place : place + 20] = bytes(20)
    log.write_bytes(data)
    assert read_info(log).as_json() == before.as_json()


def test_a_wrong_index_is_not_believed(tmp_path: Path) -> None:
    log = log_in(tmp_path)
    before, data = read_info(log), bytearray(log.read_bytes())
    data[-40] ^= 1  # within the index, in front of the footer
    log.write_bytes(data)
    info = read_info(log)
    assert (info.by_index, info.state) == (False, DAMAGED)
    assert any("index" in reason for reason in info.damage)
    assert info.topics == before.topics


def test_a_log_without_its_end_is_open(tmp_path: Path) -> None:
    log = log_in(tmp_path)
    data = log.read_bytes()
    log.write_bytes(data[: len(data) // 2 + 200])
    assert read_info(log).state == OPEN


def test_a_run_directory_stands_for_its_logs(tmp_path: Path) -> None:
    logs = [log_in(tmp_path, trial) for trial in range(2)]
    assert logs_named([tmp_path]) == logs
    done = CliRunner().invoke(app, ["info", str(tmp_path), "--json"])
    found = json.loads(done.stdout)
    assert found["messages"] == sum(info["messages"] for info in found["logs"]) == 10
    with pytest.raises(UserError, match="holds no log"):
        logs_named([FOREIGN.parent])


def test_the_command_prints_one_object_or_a_table() -> None:
    log = str(FOREIGN / "clean.mcap")
    told = json.loads(CliRunner().invoke(app, ["info", log, "--json"]).stdout)
    assert (told["messages"], told["topics"]["/demo/position"]["messages"]) == (11, 11)
    assert "/demo/position" in CliRunner().invoke(app, ["info", log]).stdout
