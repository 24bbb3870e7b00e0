"""`swarm check`: sound logs pass, and each fault is found and named."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Message
from mcap.writer import Writer

from swarm.cli.main import main
from swarm.logs.check import check_log
from swarm.logs.ending import COMPLETE
from swarm.logs.identity import identify
from swarm.logs.reader import LogError
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog

MOVE = "robot/loner/move"


@pytest.fixture
def log(tmp_path: Path) -> SmallLog:
    small = SmallLog(tmp_path / "log.mcap", flush_every=10)
    small.add_curve("loner", range(100, 60, -1))
    return small


def test_a_sound_log_passes(log: SmallLog) -> None:
    found = check_log(log.close())
    assert (found.sound, found.indexed, found.messages) == (True, True, 40)
    assert found.remarks == []


def test_a_missing_index_is_a_fault(log: SmallLog, tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    data = log.close().read_bytes()
    torn.write_bytes(data[: len(data) // 2])
    found = check_log(torn)
    assert not found.indexed
    assert "cut short" in found.faults[0]
    torn.write_bytes(data[:-5])
    assert "does not end" in check_log(torn).faults[0]


def test_lost_learning_events_duplicates_and_bad_messages_are_faults(log: SmallLog) -> None:
    for sequence in (1, 2, 2, 5):
        log.add("robot/loner/move", pb.Move(number=sequence), sequence=sequence)
    log.add("robot/loner/pose", b"\xff")
    assert check_log(log.close()).faults == [
        "robot/loner/move: 1 duplicates",
        "robot/loner/pose: 1 messages that cannot be decoded",
        "robot/loner/move: 2 messages missing",
    ]


def test_lost_states_and_restarts_are_remarks(log: SmallLog) -> None:
    for sequence in (1, 2, 4):
        log.add("robot/loner/pose", pb.Pose(x_m=1.0), sequence=sequence)
    log.add("robot/loner/pose", pb.Pose(x_m=1.0), epoch=2)
    found = check_log(log.close())
    assert found.sound
    assert found.remarks == ["robot/loner/pose: 1 messages missing", "loner: restarted during the trial"]


def test_the_exit_code_says_it(
    log: SmallLog, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = log.close().read_bytes()
    (tmp_path / "torn.mcap").write_bytes(data[:-100])
    (tmp_path / "other.mcap").write_bytes(b"something else")
    codes = {}
    for name in ("log", "torn", "other"):
        monkeypatch.setattr(sys, "argv", ["swarm", "check", str(tmp_path / f"{name}.mcap"), "--json"])
        with pytest.raises(SystemExit) as left:
            main()
        codes[name] = left.value.code
    assert codes == {"log": 0, "torn": 1, "other": 2}
    sound, torn = map(json.loads, capsys.readouterr().out.splitlines())
    assert sound["sound"]
    assert torn["messages"] == 40


def moves_log(path: Path, stretches: list[range], accounts: dict[tuple[str, int], int] | None) -> Path:
    """A complete trial of moves, each stretch by another start of the robot, whose first number is 1."""
    small = SmallLog(path)
    for epoch, numbers in enumerate(stretches, start=1):
        for number in numbers:
            small.add(MOVE, pb.Move(number=number), epoch=epoch)
    small.recorder.end(COMPLETE, "", accounts)
    small.recorder.close()
    return path


@pytest.mark.parametrize(
    ("stretches", "accounts", "lacking"),
    [
        ([range(1, 21)], {(MOVE, 1): 20}, []),
        ([range(1, 11), range(11, 31)], {(MOVE, 1): 10, (MOVE, 2): 20}, []),
        ([range(41, 51)], {(MOVE, 1): 10}, [f"{MOVE}: 40 moves missing"]),
        (
            [range(1, 11), range(21, 31)],
            {(MOVE, 1): 10, (MOVE, 2): 10},
            [f"{MOVE}: 10 moves missing"],
        ),
        ([range(1, 11)], {(MOVE, 1): 13}, [f"{MOVE}: 3 messages missing"]),
        ([range(1, 11)], {(MOVE, 1): 10, (MOVE, 2): 4}, [f"{MOVE}: 4 messages missing"]),
        (
            [range(1, 11), range(11, 31)],
            {(MOVE, 2): 20},
            ["loner: gave no account of how much it sent, so that its last messages may be missing"],
        ),
    ],
)
def test_complete_is_from_the_first_number_to_the_last_across_restarts(
    tmp_path: Path,
    stretches: list[range],
    accounts: dict[tuple[str, int], int],
    lacking: list[str],
) -> None:
    found = check_log(moves_log(tmp_path / "log.mcap", stretches, accounts))
    assert (found.lacking, found.damage) == (lacking, [])


def test_numbers_before_the_first_that_was_heard_are_missing(tmp_path: Path) -> None:
    small = SmallLog(tmp_path / "log.mcap")
    for number in range(41, 51):
        small.add("robot/loner/event", pb.Event(name="e"), sequence=number)
    assert check_log(small.close()).lacking == ["robot/loner/event: 40 messages missing"]


def test_a_trial_that_did_not_come_to_its_end_is_not_complete(tmp_path: Path) -> None:
    small = SmallLog(tmp_path / "log.mcap")
    small.add(MOVE, pb.Move(number=1))
    small.recorder.end("interrupted", "the server was ended by SIGINT", None)
    small.recorder.close()
    assert check_log(small.path).faults == ["the trial was interrupted: the server was ended by SIGINT"]
    without = SmallLog(tmp_path / "without.mcap")
    without.add(MOVE, pb.Move(number=1))
    without.recorder.close()
    assert "how the trial ended is not recorded" in check_log(without.path).faults[0]


def rewritten(log: Path, change: Callable[[list[Message]], None], head: int = 1) -> Path:
    """The messages of a log changed and put under checksums and an index that are right."""
    with log.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None
        about = [record for record in reader.iter_metadata() if record.name != "chain"]
        messages = [message for _, _, message in reader.iter_messages(log_time_order=False)]
    change(messages)
    path = log.with_name("rewritten.mcap")
    with path.open("wb") as file:
        writer = Writer(file, enable_data_crcs=True)
        writer.start()
        for schema in summary.schemas.values():
            writer.register_schema(schema.name, schema.encoding, schema.data)
        for one in summary.channels.values():
            writer.register_channel(one.topic, one.message_encoding, one.schema_id, dict(one.metadata))
        for message in messages:
            writer.add_message(
                message.channel_id,
                message.log_time,
                message.data,
                message.publish_time,
                message.sequence,
            )
        for record in about * head:
            seed = {"seed": str(len(about))} if record.name == "run" else {}
            writer.add_metadata(record.name, record.metadata)
            if head > 1:
                writer.add_metadata(record.name, record.metadata | seed)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def empty_all(messages: list[Message]) -> None:
    for message in messages:
        message.data = b""


def far_future(messages: list[Message]) -> None:
    for message in messages:
        message.log_time = message.publish_time = 2**64 - 1


def reverse(messages: list[Message]) -> None:
    times = [message.log_time for message in reversed(messages)]
    for message, t_ns in zip(messages, times, strict=True):
        message.log_time = t_ns


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (empty_all, "robot/loner/best_path: 40 messages that cannot be decoded"),
        (far_future, "robot/loner/best_path: times that cannot be, before the run or centuries after"),
        (reverse, "robot/loner/best_path: received in another order than recorded"),
    ],
)
def test_messages_that_cannot_be_are_damage_under_the_best_of_checksums(
    log: SmallLog, change: Callable[[list[Message]], None], fault: str
) -> None:
    found = check_log(rewritten(log.close(), change))
    assert found.damage == [fault]


def test_a_legal_log_with_its_metadata_at_the_end_is_sound(log: SmallLog) -> None:
    """And with its schemas and channels in the chunks alone, as the `mcap` package writes them."""
    found = check_log(rewritten(log.close(), lambda _: None))
    assert (found.sound, found.messages) == (True, 40)


def test_two_records_that_say_different_things_of_the_run_are_damage(log: SmallLog) -> None:
    twice = rewritten(log.close(), lambda _: None, head=2)
    assert "two metadata records 'run' that differ" in check_log(twice).damage[0]
    with pytest.raises(LogError, match="two metadata records that differ"):
        identify(twice)
