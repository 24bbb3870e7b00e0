"""The logbook under load: messages a second into a log, and a long run's log read again. One line of JSON.

    python -m tests.benchmarks.logbook

- `recorded`: four processes publish messages of 200 bytes, reliably, and one process records them as the
  server does, against the same subscriber that writes nothing, in turn; with the share that arrived.
- `large`: a log of 2 million messages of three robots, as in ten hours: how much memory its recorder took
  from a tenth of it on, and how long `swarm info`, one table, and all of it to Parquet take, each a process.
"""

from __future__ import annotations

import json
import multiprocessing
import resource
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import polars as pl

from server.hubs.hub import Batch
from server.recording.latched import LatchedState
from server.recording.trial_recorder import TrialRecorder
from swarm.clock import unix_clock
from swarm.config.experiment import Experiment
from swarm.logs.ending import COMPLETE
from swarm.logs.identity import identify
from swarm.logs.parquet import read_logs
from swarm.logs.reader import LogReader
from swarm.logs.tables import rows
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import Delivery
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.small_logs import metadata
from tests.support.swarm_runs import ROOT, experiment_text, write_experiment

PUBLISHERS, KEYS_EACH, MESSAGES_EACH, ROUNDS = 4, 5, 100_000, 3
PAYLOAD = bytes(200)
LARGE_MESSAGES = 2_000_000
TICK_NS = 100_000_000
MIB = 1 << 20


def publish(endpoint: str, number: int) -> None:
    """Say so many messages under keys of one's own, and wait until the receiver has gone."""
    with Session(SessionSettings(endpoint)) as session:
        keys = [f"robot/r{number}x{key}/move" for key in range(KEYS_EACH)]
        publishers = [session.publisher(key, Delivery.EVERY) for key in keys]
        while not session.alive("alive/receiver"):
            pass
        for sequence in range(1, MESSAGES_EACH // KEYS_EACH + 1):
            header = Header(number + 1, sequence, sequence).pack()
            for publisher in publishers:
                publisher.put(PAYLOAD, attachment=header)
        for _ in unix_clock().ticks(0.1):
            if not session.alive("alive/receiver"):
                return


def trial_recorder(place: Path) -> TrialRecorder:
    experiment = Experiment.load(write_experiment(place, experiment_text()))
    return TrialRecorder(
        lambda part: place / f"trial-000-{part}.mcap",
        lambda _: metadata(),
        experiment.log,
        LatchedState(experiment),
    )


def received_per_s(place: Path | None) -> tuple[float, int]:
    """Messages a second, and how many; into a log if there is a place for it."""
    endpoint, expected = free_endpoint(), PUBLISHERS * MESSAGES_EACH
    senders = [multiprocessing.Process(target=publish, args=(endpoint, one)) for one in range(PUBLISHERS)]
    with Session(SessionSettings(endpoint, hub=True)) as session:
        inbox = session.inbox("robot/**", Delivery.EVERY)
        recorder = trial_recorder(place) if place else None
        for sender in senders:
            sender.start()
        session.declare_alive("alive/receiver")
        count, began_s, last_s = 0, 0.0, time.monotonic()
        while count < expected and time.monotonic() - last_s < 10.0:
            samples = inbox.poll()
            if not samples:
                continue
            began_s = began_s or time.monotonic()
            last_s = time.monotonic()
            items = [
                Item(sample.key, header, sample.payload)
                for sample in samples
                if (header := Header.unpack(sample.attachment))
            ]
            count += len(items)
            if recorder:
                recorder.write(Batch(count, items))
        if recorder:
            recorder.flush()
        elapsed_s = time.monotonic() - began_s
        if recorder:
            recorder.end(COMPLETE, "", None)
            recorder.close()
    for sender in senders:
        sender.join()
    return count / elapsed_s, count


def recorded() -> dict[str, Any]:
    """Medians over rounds, the two in turn."""
    bare, logged, shares = [], [], []
    for _ in range(ROUNDS):
        bare.append(received_per_s(None)[0])
        with tempfile.TemporaryDirectory(dir=ROOT) as folder:
            rate, count = received_per_s(Path(folder))
        logged.append(rate)
        shares.append(count / (PUBLISHERS * MESSAGES_EACH))
    return {
        "bare_per_s": round(median(bare)),
        "recorded_per_s": round(median(logged)),
        "ratio": round(median(logged) / median(bare), 3),
        "share": min(shares),
    }


def write_large(place: Path) -> float:
    """Write the log; MiB of memory that it took after the first tenth."""
    recorder = trial_recorder(place)
    names = ("expert", "imitator", "loner")
    after_tenth_kib = 0
    for tick in range(1, LARGE_MESSAGES // (3 * len(names)) + 1):
        t_ns = tick * TICK_NS
        pose = pb.Pose(
            x_m=tick % 997 / 300, y_m=tick % 991 / 300, theta_rad=tick % 983 / 160, captured_t_ns=t_ns
        )
        command = pb.Command(
            left_steps_per_s=tick % 89, right_steps_per_s=tick % 97, x_m=pose.x_m, y_m=pose.y_m
        )
        truth = pb.Truth(x_m=pose.x_m, y_m=pose.y_m, theta_rad=pose.theta_rad)
        header = Header(1, tick, t_ns)
        said = {"pose": pose, "command": command, "truth": truth}
        packed = {what: message.SerializeToString() for what, message in said.items()}
        items = [
            Item(f"{'sim' if what == 'truth' else 'robot'}/{name}/{what}", header, payload)
            for name in names
            for what, payload in packed.items()
        ]
        if tick % 25 == 0:
            number = tick // 25
            move = pb.Move(number=number, state=number % 64, action=number % 8, q_value=1 / number)
            items += [
                Item(f"robot/{name}/move", Header(1, number, t_ns), move.SerializeToString())
                for name in names
            ]
        recorder.write(Batch(t_ns, items))
        if tick % 5 == 0:
            recorder.flush()
        if tick == LARGE_MESSAGES // (30 * len(names)):
            after_tenth_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    recorder.end(COMPLETE, "", None)
    recorder.close()
    return (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - after_tenth_kib) / 1024


def one_table(log: Path) -> int:
    """The moves alone; how many."""
    identity = identify(log)
    reader = LogReader(log, lambda channel: channel.topic is topics.MOVE)
    return sum(rows(part, identity).tables[0].frame.height for part in reader.parts() if part.payloads)


def all_to_parquet(log: Path, folder: Path) -> int:
    """Everything; how many rows of poses."""
    tables = read_logs([identify(log)], folder, sampled=True, show=lambda _: None).tables
    return int(pl.scan_parquet(tables["poses"]).select(pl.len()).collect().item())


def seconds(call: str, *words: object) -> float:
    """Of a process of its own, its start included."""
    began_s = time.monotonic()
    subprocess.run(
        [sys.executable, *call.split(), *map(str, words)], check=True, stdout=subprocess.DEVNULL, cwd=ROOT
    )
    return round(time.monotonic() - began_s, 2)


def large() -> dict[str, Any]:
    with tempfile.TemporaryDirectory(dir=ROOT) as folder:
        place = Path(folder)
        with multiprocessing.Pool(1) as pool:
            grown_mib = pool.apply(partial(write_large, place))
        (log,) = place.glob("*.mcap")
        here = "-m tests.benchmarks.logbook"
        return {
            "messages": LARGE_MESSAGES,
            "log_mib": round(log.stat().st_size / MIB, 1),
            "memory_grown_mib": round(grown_mib, 1),
            "info_s": seconds("-m swarm info --json", log),
            "one_table_s": seconds(f"{here} moves", log),
            "parquet_s": seconds(f"{here} parquet", log, place),
            "check_s": seconds("-m swarm check", log),
        }


def main(words: list[str]) -> None:
    if words[:1] == ["moves"]:
        print(one_table(Path(words[1])))
    elif words[:1] == ["parquet"]:
        print(all_to_parquet(Path(words[1]), Path(words[2])))
    else:
        print(json.dumps({"recorded": recorded(), "large": large()}))


if __name__ == "__main__":
    multiprocessing.set_start_method("spawn")
    main(sys.argv[1:])
