"""No damage to any byte of a log passes as sound, and all that it has not touched is recovered."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest

from swarm.logs.check import check_log
from swarm.logs.reader import LogError
from swarm.logs.recover import recover_log
from swarm.messages import swarm_pb2 as pb
from tests.support.damage import KINDS, defined, stretches, surviving, told, wounds
from tests.support.small_logs import SmallLog

EACH = 12


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight chunks of five keys, with the definitions between them as they come up."""
    small = SmallLog(tmp_path_factory.mktemp("damage") / "log.mcap", flush_every=15)
    for number in range(1, 31):
        small.add("robot/loner/pose", pb.Pose(x_m=number / 100, captured_t_ns=number))
        small.add("robot/loner/move", pb.Move(number=number, state=number))
        small.add("robot/loner/status", pb.Status(activity="driving", moves=number))
        if number > 15:
            small.add("robot/expert/move", pb.Move(number=number - 15))
            small.add("robot/expert/pose", pb.Pose(y_m=number / 100, captured_t_ns=number))
    return small.close()


@pytest.mark.parametrize("kind", KINDS)
def test_damage_shows_and_costs_only_what_it_touches(log: Path, tmp_path: Path, kind: str) -> None:
    chunks, written = stretches(log), told(log)
    assert sum(len(chunk.messages) for chunk in chunks) == written.total() == 120
    assert check_log(log).sound
    definitions = defined(log)
    broken, whole = tmp_path / "broken.mcap", tmp_path / "whole.mcap"
    for wound in wounds(log, chunks, EACH, seed=1):
        if wound.kind != kind or wound.data == log.read_bytes():
            continue
        broken.write_bytes(wound.data)
        place = (wound.kind, wound.region, wound.begin, wound.end)
        with suppress(LogError):
            assert not check_log(broken).sound, place
        expected = surviving(chunks, wound)
        whole.unlink(missing_ok=True)
        try:
            recovery = recover_log(broken, whole)
        except LogError:
            assert not expected or wound.begin < 8, place
            continue
        assert expected <= told(whole) <= written, place
        assert defined(whole) <= definitions, "no key and no schema is invented"
        assert recovery.lost, place
        assert all(damage.reason for damage in recovery.lost)
        assert broken.read_bytes() == wound.data
