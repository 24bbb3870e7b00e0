"""The recorder against a plain buffered write of the same payloads, as a ratio of their rates.

    python -m tests.benchmarks.recorder

Counted in the processor's time, of which a busy machine takes nothing away. "laid down" is what a run does;
"chunks alone" never lays an open chunk down: the difference is what it costs that a kill loses but a moment.
"sync_ms" is how long the disk takes for a second of such messages; the recorder's own thread waits for it.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import IO

from server.hubs.hub import Batch
from server.recording.recorder import Recorder
from swarm.messages.header import Header, Item

ROBOTS, BATCHES, ROUNDS = 20, 5_000, 3


def batches() -> list[Batch]:
    """A pose and a command of each robot, ten times a second."""
    keys = [f"robot/r{robot}/{kind}" for robot in range(ROBOTS) for kind in ("command", "pose")]
    return [
        Batch(
            number * 100_000_000,
            [Item(key, Header(1, number, number), number.to_bytes(8, "big") * 8) for key in keys],
        )
        for number in range(1, BATCHES + 1)
    ]


def written(path: Path, work: list[Batch]) -> None:
    """The floor: the bytes alone."""
    with path.open("wb") as file:
        for batch in work:
            for item in batch.items:
                file.write(item.payload)


def recorded(path: Path, work: list[Batch], monotonic_s: Callable[[], float]) -> None:
    """A log; a clock that stands still lays nothing down after the first batch."""
    recorder = Recorder(path, {}, monotonic_s)
    for batch in work:
        recorder.write(batch)
    recorder.close()


def rate(work: list[Batch], write: Callable[[Path, list[Batch]], None]) -> float:
    """Messages a second, the best of a few rounds."""
    best_s = float("inf")
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory(dir=".") as folder:
            began_s = time.process_time()
            write(Path(folder) / "log", work)
            best_s = min(best_s, time.process_time() - began_s)
    return sum(len(batch.items) for batch in work) / best_s


def sync_ms() -> float:
    """The median time to bring another 50 kB to the disk."""
    with tempfile.TemporaryFile(dir=".") as file:
        return median(_sync_ms(file) for _ in range(20))


def _sync_ms(file: IO[bytes]) -> float:
    file.write(bytes(50_000))
    file.flush()
    began_s = time.perf_counter()
    os.fdatasync(file.fileno())
    return (time.perf_counter() - began_s) * 1e3


def main() -> None:
    work = batches()
    floor = rate(work, written)
    full = rate(work, lambda path, batches: recorded(path, batches, time.monotonic))
    alone = rate(work, lambda path, batches: recorded(path, batches, lambda: 0.0))
    figures = {"laid down": full / floor, "chunks alone": alone / floor, "sync_ms": sync_ms()}
    print(json.dumps({"plain_per_s": round(floor)} | {name: round(one, 3) for name, one in figures.items()}))


if __name__ == "__main__":
    main()
