"""Files that this project did not write, against what two other programs find in them."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader

from swarm.logs.reader import LogError, LogReader
from swarm.logs.recover import recover_log
from tests.support.damage import Told, told
from tests.support.swarm_runs import ROOT

FOLDER = ROOT / "tests" / "data" / "mcap"
CASES = {
    case["file"]: case
    for case in json.loads((FOLDER / "expected.json").read_text())["cases"]
    if (FOLDER / case["file"]).exists()
}


def theirs(path: Path) -> Counter[Told]:
    """What the `mcap` package reads from front to back, up to where it cannot go on."""
    found: Counter[Told] = Counter()
    with path.open("rb") as file:
        try:
            for _, channel, one in NonSeekingReader(file, validate_crcs=True).iter_messages(
                log_time_order=False
            ):
                found[channel.topic, one.sequence, one.log_time, one.data] += 1
        except McapError:
            pass
    return found


def ours(reader: LogReader) -> Counter[Told]:
    found: Counter[Told] = Counter()
    for part in reader.parts():
        rows = zip(part.sequence, part.receive_t_ns, part.payloads, strict=True)
        found.update((part.channel.key, int(number), int(t_ns), payload) for number, t_ns, payload in rows)
    return found


@pytest.mark.parametrize("name", CASES)
def test_what_can_be_read_is_read_and_what_cannot_is_said(name: str, tmp_path: Path) -> None:
    path, whole = FOLDER / name, tmp_path / "whole.mcap"
    readable = CASES[name]["checks"]["C01"] != "fail"
    reader = LogReader(path)
    try:
        found = ours(reader)
    except LogError:
        assert not readable
        with pytest.raises(LogError):
            recover_log(path, whole)
        return
    assert found == theirs(path)
    assert (reader.damage == []) == readable
    recovery = recover_log(path, whole)
    assert told(whole) == found
    assert (recovery.lost == []) == readable
    assert bool(reader.unverified) == (CASES[name]["checks"]["C01"] == "warn")
