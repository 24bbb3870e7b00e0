"""The hash chain: what a checksum of 32 bits cannot tell, and which log goes on from which."""

from __future__ import annotations

import hashlib
import zlib
from pathlib import Path

from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from zstandard import ZstdDecompressor

from swarm.logs.chain import CHAIN, CONTINUES, last_link
from swarm.logs.check import check_log, check_run
from swarm.logs.reader import LogReader
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog, metadata


def logs_of(run: Path, second_goes_on_from: str = "") -> tuple[Path, Path]:
    """Two parts of a trial, four chunks each."""
    run.mkdir()
    first = SmallLog(run / "trial-000.mcap", flush_every=5)
    first.add_curve("loner", range(100, 80, -1))
    first.recorder.end("continued", "", {})
    first.recorder.close()
    about = metadata()
    about["run"] |= {"part": "2"}
    link = second_goes_on_from or last_link(LogReader(first.path).read_metadata())
    second = SmallLog(run / "trial-000-2.mcap", about | {CONTINUES: {"sha256": link}}, flush_every=5)
    second._numbers.update(first._numbers)
    second.t_ns = first.t_ns
    second.add_curve("loner", range(80, 60, -1), first_move=210)
    return first.path, second.close()


def test_anybody_can_compute_it(tmp_path: Path) -> None:
    for log in logs_of(tmp_path / "run"):
        said = LogReader(log).read_metadata()
        link = said.get(CONTINUES, {}).get("sha256", "")
        with log.open("rb") as file:
            for record in StreamReader(file, emit_chunks=True).records:
                if isinstance(record, Chunk):
                    chunk = ZstdDecompressor().decompress(record.data, record.uncompressed_size)
                    link = hashlib.sha256(link.encode() + chunk).hexdigest()
        assert said[CHAIN] == {"sha256": link, "chunks": "4"}
    assert check_run(tmp_path / "run")[0].faults == []


def test_a_log_in_the_place_of_another_is_found(tmp_path: Path) -> None:
    logs_of(tmp_path / "run", second_goes_on_from="0" * 64)
    assert check_run(tmp_path / "run")[0].damage == [
        "trial-000-2.mcap does not go on from trial-000.mcap (hash chain)"
    ]


def test_a_log_whose_checksums_were_mended_is_found(tmp_path: Path) -> None:
    """Somebody writes the log anew with one value changed; every checksum is right."""
    forged, honest = (SmallLog(tmp_path / name, flush_every=5) for name in ("forged.mcap", "honest.mcap"))
    for log, length in ((forged, 14), (honest, 15)):
        log.add("robot/loner/best_path", pb.BestPath(move=10, length=length, cap=100))
        log.close()
    link = last_link(LogReader(honest.path).read_metadata())
    with forged.path.open("rb") as file:
        own = next(one.metadata for one in make_reader(file).iter_metadata() if one.name == CHAIN)["sha256"]
    data = forged.path.read_bytes()
    forged.path.write_bytes(_with_checksums(data.replace(own.encode(), link.encode())))
    found = check_log(forged.path)
    assert found.damage == ["the chunks are not those that were recorded (hash chain)"]


def _with_checksums(data: bytes) -> bytes:
    """The checksum over all records in the data end record made right."""
    at = data.rindex(b"\x0f" + (4).to_bytes(8, "little"))
    return data[: at + 9] + zlib.crc32(data[:at]).to_bytes(4, "little") + data[at + 13 :]
