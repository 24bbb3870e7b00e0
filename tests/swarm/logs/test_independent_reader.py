"""A real run's log, opened by a reader that this project did not write, with nothing but the file itself."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from swarm.analysis.analyze import Request, analyze
from swarm.logs.reader import LogReader
from tests.support.swarm_runs import ROOT

EXPERIMENT = ROOT / "deploy" / "sim" / "demo.toml"
MOVES = 20


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty moves of the demonstration, in real processes."""
    out = tmp_path_factory.mktemp("independent") / "run"
    words = ["server", str(EXPERIMENT), "--moves", str(MOVES), "--out", str(out)]
    subprocess.run([sys.executable, "-m", *words], check=True, capture_output=True)
    return out


def read_independently(log: Path) -> list[tuple[str, int, Any]]:
    """(topic, sequence, message decoded with the schemas that the file carries) in the file's order."""
    with log.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        return [
            (channel.topic, message.sequence, decoded)
            for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False)
        ]


def test_both_readers_find_the_same_messages(run: Path) -> None:
    log = run / "trial-000.mcap"
    theirs = Counter(topic for topic, _, _ in read_independently(log))
    ours: Counter[str] = Counter()
    reader = LogReader(log)
    for part in reader.parts():
        ours[part.channel.key] += len(part.sequence)
    assert ours == theirs
    assert reader.messages == reader.recorded_messages == sum(theirs.values()) > 1000
    assert reader.damage == []


def test_the_tables_say_what_the_independent_reader_decodes(run: Path) -> None:
    messages = read_independently(run / "trial-000.mcap")
    tables = analyze(Request([run])).files
    for name, kind in (("moves", "move"), ("poses", "pose"), ("best_paths", "best_path")):
        key = f"robot/loner/{kind}"
        table = pl.read_parquet(tables[name]).filter(robot="loner").sort("sequence")
        theirs = [(sequence, message) for topic, sequence, message in messages if topic == key]
        fields = [field.name for field in theirs[0][1].DESCRIPTOR.fields]
        expected = [(sequence, *(getattr(message, name) for name in fields)) for sequence, message in theirs]
        assert table.select("sequence", *fields).rows() == expected


def test_a_simulated_run_loses_nothing(run: Path) -> None:
    health = pl.read_parquet(analyze(Request([run])).files["health"])
    assert health["missing"].sum() == health["duplicates"].sum() == health["rejected"].sum() == 0
    assert health["first_sequence"].unique().to_list() == [1]
    moves = health.filter(key="robot/loner/move")["messages"].to_list()
    assert moves == [MOVES]
