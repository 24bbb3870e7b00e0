"""A trial's log in several files: each stands alone, together they are one; a full disk costs nothing."""

from __future__ import annotations

import json
import resource
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from server.hubs.hub import Batch
from server.recording.latched import LATCHED, LatchedState
from server.recording.trial_recorder import MORE_BYTES, TrialRecorder
from server.run_directory import RunDirectory
from swarm import open_run
from swarm.checkup.machine import RESERVE_BYTES
from swarm.config.experiment import Experiment, LogSettings
from swarm.logs.check import check_log, check_run
from swarm.logs.ending import COMPLETE
from swarm.logs.reader import LogReader
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from swarm.messages.topics import VIEW_ARENA
from tests.support.small_logs import metadata
from tests.support.swarm_runs import experiment_text, write_experiment

TICK_NS = 100_000_000
ROOM = RESERVE_BYTES + MORE_BYTES


class Disk:
    """A disk whose room a test sets."""

    def __init__(self) -> None:
        self.free_bytes = ROOM

    def __call__(self, place: Path) -> int:
        assert place.is_dir()
        return self.free_bytes


class SegmentedLog:
    """A trial of one robot that makes moves, a flush after each."""

    def __init__(self, run: Path, settings: LogSettings, disk: Callable[[Path], int], seed: int = 1) -> None:
        run.mkdir(exist_ok=True)
        self.seed = seed
        self.directory = RunDirectory(run)
        self.experiment = Experiment.load(write_experiment(run.parent, experiment_text()))
        self.open(settings, disk)
        self.moves = 0

    def open(self, settings: LogSettings, disk: Callable[[Path], int]) -> None:
        latched = LatchedState(self.experiment)
        latched.take_up(self.directory.logs(0))
        part, path_of = self.directory.next_part(0), partial(self.directory.log, 0)
        self.recorder = TrialRecorder(path_of, self._about, settings, latched, part, disk)

    def move(self) -> None:
        self.moves += 1
        t_ns, header = self.moves * TICK_NS, Header(5, self.moves, self.moves * TICK_NS)
        move = pb.Move(number=self.moves, state=self.moves % 4, action=1, q_value=self.moves / 7, track=1)
        pose = pb.Pose(x_m=0.5)
        items = [
            Item("robot/loner/move", header, move.SerializeToString()),
            Item("robot/loner/pose", header, pose.SerializeToString()),
        ]
        self.recorder.write(Batch(t_ns, items))
        self.recorder.flush()

    def close(self) -> None:
        self.recorder.end(COMPLETE, "", None)
        self.recorder.close()

    def _about(self, part: int) -> dict[str, dict[str, str]]:
        about = metadata(seed=self.seed)
        later = {"part": str(part)} if part > 1 else {}
        return about | {"run": about["run"] | later}


@pytest.fixture
def hourly(tmp_path: Path) -> SegmentedLog:
    """A file holds four moves, and then a fifth that shows that the time is over."""
    log = SegmentedLog(tmp_path / "run", LogSettings(file_h=4 * TICK_NS / 3.6e12), Disk())
    path = pb.PathRemembered(path=1, moves=[1, 2], source="given").SerializeToString()
    log.recorder.write(Batch(TICK_NS, [Item("robot/loner/path", Header(5, 1, TICK_NS), path)]))
    log.recorder.write_view(VIEW_ARENA, pb.Event(name="drawn once"), TICK_NS)
    for _ in range(12):
        log.move()
    log.close()
    return log


def names(log: SegmentedLog) -> list[str]:
    return sorted(path.name for path in log.directory.path.iterdir())


def test_a_log_goes_on_in_another_file_when_its_time_is_over(hourly: SegmentedLog) -> None:
    assert names(hourly) == ["trial-000-2.mcap", "trial-000-3.mcap", "trial-000.mcap"]
    (found,) = check_run(hourly.directory.path)
    assert (found.faults, found.messages) == ([], 1 + 2 * 12 + 3)
    moves = open_run(hourly.directory.path).table("moves").collect()
    assert moves["number"].to_list() == list(range(1, 13))


def test_each_file_can_be_read_and_checked_alone(hourly: SegmentedLog) -> None:
    logs = hourly.directory.logs(0)
    assert [check_log(log).faults for log in logs] == [[], [], []]
    reader = LogReader(logs[2])
    assert VIEW_ARENA in {part.channel.key for part in reader.parts()}
    latched = json.loads(reader.metadata[LATCHED]["loner"])
    begins_at = int(min(part.sequence.min() for part in reader.parts() if part.channel.key.endswith("move")))
    assert (latched["moves"], latched["paths"]) == (begins_at - 1, {"1": [1, 2]})
    last = max(number for number in range(begins_at) if number % 4 == 3)
    assert latched["q"][3][1] == last / 7, "to the last bit"


def test_a_log_goes_on_in_another_file_when_it_is_large(tmp_path: Path) -> None:
    log = SegmentedLog(tmp_path / "run", LogSettings(file_mb=0.002), Disk())
    for _ in range(30):
        log.move()
    log.close()
    sizes = [path.stat().st_size for path in log.directory.logs(0)]
    assert len(sizes) > 2
    assert check_run(log.directory.path)[0].faults == []


def test_a_file_that_is_missing_is_named(hourly: SegmentedLog) -> None:
    hourly.directory.log(0, 2).unlink()
    faults = check_run(hourly.directory.path)[0].faults
    assert "part 2 of trial 0 is not here" in faults
    assert any("moves missing" in fault or "messages missing" in fault for fault in faults)
    hourly.directory.log(0, 3).unlink()
    faults = check_run(hourly.directory.path)[0].faults
    assert faults == ["the trial goes on in a later log, which is not here"]


def test_a_file_that_is_there_twice_or_of_another_run_is_named(hourly: SegmentedLog, tmp_path: Path) -> None:
    run = hourly.directory.path
    (run / "trial-000-7.mcap").write_bytes(hourly.directory.log(0, 2).read_bytes())
    other = SegmentedLog(tmp_path / "other", LogSettings(), Disk(), seed=2)
    other.move()
    other.close()
    (run / "trial-009.mcap").write_bytes(other.directory.log(0).read_bytes())
    faults = [fault for found in check_run(run) for fault in found.faults]
    assert "trial-000-7.mcap is part 2 of trial 0 once more" in faults
    assert "trial-009.mcap is of another run than trial-000.mcap" in faults


def test_while_the_disk_is_full_moves_wait_and_the_file_is_closed(tmp_path: Path) -> None:
    disk = Disk()
    log = SegmentedLog(tmp_path / "run", LogSettings(), disk)
    log.move()
    disk.free_bytes = RESERVE_BYTES - 1
    log.move()
    assert "the disk of" in log.recorder.waits_for
    assert names(log) == ["trial-000.mcap"]
    assert check_log(log.directory.log(0)).faults == []
    disk.free_bytes = RESERVE_BYTES + 1
    log.move()
    assert log.recorder.waits_for, "it would be full again at once"
    disk.free_bytes = ROOM
    log.move()
    assert not log.recorder.waits_for
    log.move()
    log.close()
    (found,) = check_run(log.directory.path)
    assert found.faults == []
    assert found.remarks == ["robot/loner/pose: 2 messages missing"]
    assert log.recorder.left_out.while_paused == {"robot/loner/pose": 2}
    moves = open_run(log.directory.path).table("moves").collect()
    assert moves["number"].to_list() == [1, 2, 3, 4, 5]


def test_a_disk_that_takes_no_more_in_the_midst_costs_nothing(tmp_path: Path) -> None:
    """A file may not become larger than 3 kB for a while: writing fails as on a disk that is full."""
    log = SegmentedLog(tmp_path / "run", LogSettings(), Disk())
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (6000, hard))
    try:
        while not log.recorder.waits_for:
            log.move()
        assert "File too large" in log.recorder.waits_for
        log.move()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    log.move()
    log.move()
    log.close()
    assert "File too large" in log.recorder.disk_error
    assert not [name for name in names(log) if name.endswith(".part")]
    (found,) = check_run(log.directory.path)
    assert found.faults == []
    moves = open_run(log.directory.path).table("moves").collect()
    assert moves["number"].to_list() == list(range(1, log.moves + 1))


def test_what_a_killed_server_left_open_is_closed_and_gone_on_from(tmp_path: Path) -> None:
    log = SegmentedLog(tmp_path / "run", LogSettings(), Disk())
    for _ in range(5):
        log.move()
    (left,) = log.directory.path.iterdir()
    copy = left.read_bytes()
    log.recorder.close()
    (log.directory.path / "trial-000.mcap").unlink()
    left.write_bytes(copy[:-3])
    (tmp_path / "run" / "trial-001.mcap.part").write_bytes(b"")
    log.directory.close_logs()
    assert names(log) == ["trial-000.mcap"]
    assert check_log(log.directory.log(0)).faults == ["the trial was interrupted: its server was killed"], (
        "that it ends early is no damage"
    )
    kept = open_moves(log)
    log.open(LogSettings(), Disk())
    log.moves = len(kept)
    for _ in range(3):
        log.move()
    log.close()
    assert check_run(log.directory.path)[0].faults == []
    assert open_moves(log) == list(range(1, log.moves + 1))


def open_moves(log: SegmentedLog) -> list[int]:
    return open_run(log.directory.path).table("moves").collect()["number"].to_list()
