"""Small logs for tests, written by the server's own recorder, a batch a tenth of a second."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from google.protobuf.message import Message

from server.hubs.hub import Batch
from server.recording.recorder import Recorder
from swarm.logs.ending import COMPLETE
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item

TICK_NS = 100_000_000
ROBOTS = {"expert": "expert expert", "imitator": "learner imitation", "loner": "learner no-imitation"}


def metadata(
    trial: int = 0, seed: int = 1, robots: Mapping[str, str] | None = None
) -> dict[str, dict[str, str]]:
    """What the server writes at the head of a log."""
    return {
        "experiment": {"toml": "[run]\n"},
        "run": {"name": "small", "seed": str(seed), "moves": "100", "trial": str(trial)},
        "robots": dict(robots or ROBOTS),
        "versions": {"commit": "0" * 40},
    }


@dataclass
class SmallLog:
    """Numbers messages by key and epoch as senders do, and flushes a chunk every `flush_every` messages."""

    path: Path
    head: dict[str, dict[str, str]] = field(default_factory=metadata)
    flush_every: int = 1000
    _numbers: dict[tuple[str, int], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.recorder = Recorder(self.path, self.head)
        self.t_ns = 0

    def add(self, key: str, message: Message | bytes, epoch: int = 1, sequence: int | None = None) -> None:
        """One message, a tenth of a second after the one before."""
        number = self._numbers.get((key, epoch), 0) + 1 if sequence is None else sequence
        self._numbers[key, epoch] = number
        payload = message if isinstance(message, bytes) else message.SerializeToString()
        self.t_ns += TICK_NS
        self.recorder.write(Batch(self.t_ns, [Item(key, Header(epoch, number, self.t_ns), payload)]))
        if self.recorder.messages % self.flush_every == 0:
            self.recorder.flush()

    def add_curve(self, robot: str, lengths: Sequence[int], epoch: int = 1, first_move: int = 10) -> None:
        """Best path lengths, every ten moves."""
        for place, length in enumerate(lengths):
            best = pb.BestPath(move=first_move + 10 * place, length=length, cap=100)
            self.add(f"robot/{robot}/best_path", best, epoch)

    def close(self) -> Path:
        """As at the end of a trial in lockstep, in which all that was sent is heard."""
        self.recorder.end(COMPLETE, "", None)
        self.recorder.close()
        return self.path


def learning_log(path: Path, curves: Mapping[str, Sequence[int]], trial: int = 0, seed: int = 1) -> Path:
    """A closed log of one trial with a curve for each robot."""
    log = SmallLog(path, metadata(trial, seed))
    for robot, lengths in curves.items():
        log.add_curve(robot, lengths)
    return log.close()
