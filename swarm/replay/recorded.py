"""What a log says of each robot's learning, in the order in which the robot said it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from google.protobuf.message import Message

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.geometry import MOVES
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.reader import LogError, LogReader, Part
from swarm.logs.trial_logs import logs_of_trial
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.messages.validation import BadMessageError, decode

STORY = (topics.PATH, topics.VISIT, topics.EVENT, topics.MOVE)
"""What changes a learner, in the order in which things of one moment happen."""
RESULTS = (topics.REPLAY, topics.BEST_PATH)
"""What a learner says about it, beside its moves."""


@dataclass(frozen=True, eq=False)
class Said:
    """A message of a robot, and the start (epoch) of the process that sent it."""

    epoch: int
    message: Any


Timed = tuple[int, int, Said]
"""When, in nanoseconds of the run, and where in STORY."""


@dataclass
class RecordedLearning:
    """One robot's part of a log."""

    story: list[Said] = field(default_factory=list)
    results: dict[tuple[Topic[Any], int], list[Any]] = field(default_factory=lambda: defaultdict(list))
    """(topic, epoch) -> messages."""

    def steps(self) -> list[tuple[list[Said], Said]]:
        """Each move, with what happened since the move before."""
        found: list[tuple[list[Said], Said]] = []
        between: list[Said] = []
        for said in self.story:
            if isinstance(said.message, pb.Move):
                found.append((between, said))
                between = []
            else:
                between.append(said)
        return found

    @property
    def paths(self) -> set[int]:
        """The numbers of all paths that were ever remembered."""
        return {said.message.path for said in self.story if isinstance(said.message, pb.PathRemembered)}

    def first_moves(self) -> dict[int, int]:
        """Epoch -> the number of its first move: above 1 for a robot that went on from a checkpoint."""
        found: dict[int, int] = {}
        for _, said in self.steps():
            found.setdefault(said.epoch, said.message.number)
        return found


@dataclass(frozen=True)
class Recording:
    """A log's experiment, and what its learners learnt."""

    identity: LogIdentity
    experiment_toml: str
    learning: dict[str, RecordedLearning]
    remarks: list[str]
    """Damage of the log, messages that cannot be decoded."""

    def experiment(self, changes: dict[str, Any]) -> Experiment:
        """As it was run, but for changes of [learning]; UserError for what no experiment can say."""
        experiment = Experiment.of_log(self.identity.name, self.experiment_toml, changes)
        return experiment.changed(seed=self.identity.seed, moves=self.identity.moves)


def read_recording(logs: Sequence[Path]) -> Recording:
    """Everything about learning in the logs of a trial, or in a run directory of one trial."""
    logs = logs_of_trial(logs)
    identities = [identify(path) for path in logs]
    identity = identities[0]
    for other in identities[1:]:
        if (other.run, other.replicate) != (identity.run, identity.replicate):
            raise UserError(f"{identity.path} and {other.path} are of two trials; replay each by itself")
    recording = Recording(
        identity, "", {robot: RecordedLearning() for robot in sorted(identity.learners)}, []
    )
    timed: dict[str, list[Timed]] = defaultdict(list)
    experiments = [_read(path, recording, timed) for path in logs]
    for robot, entries in timed.items():
        _check_cells(identity, [said.message for _, _, said in entries])
        recording.learning[robot].story = [said for *_, said in sorted(entries, key=lambda entry: entry[:2])]
    return replace(recording, experiment_toml=experiments[0])


def _read(path: Path, recording: Recording, timed: dict[str, list[Timed]]) -> str:
    """Take in one log; returns its experiment."""
    reader = LogReader(path, lambda channel: channel.topic in (*STORY, *RESULTS))
    for part in reader.parts():
        topic, epoch = part.channel.topic, part.channel.epoch
        learning = recording.learning.get(part.channel.publisher)
        if topic is None or learning is None or not part.payloads:
            continue
        for t_ns, message in _messages(part, topic, recording.remarks):
            if topic in RESULTS:
                learning.results[topic, epoch].append(message)
            else:
                timed[part.channel.publisher].append((t_ns, STORY.index(topic), Said(epoch, message)))
    recording.remarks.extend(map(str, reader.damage))
    return reader.metadata.get("experiment", {}).get("toml", "")


def _messages(part: Part, topic: Topic[Any], remarks: list[str]) -> Iterator[tuple[int, Message]]:
    for t_ns, sequence, payload in zip(part.publish_t_ns, part.sequence, part.payloads, strict=True):
        try:
            yield int(t_ns), decode(topic.message, payload)
        except BadMessageError as error:
            remarks.append(f"{part.channel.key}: message {sequence} is left out: {error}")


def _check_cells(identity: LogIdentity, messages: Iterable[Any]) -> None:
    """LogError for moves that no grid of this experiment has."""
    states = identity.grid.states
    for message in messages:
        moves = message.moves if isinstance(message, pb.PathRemembered) else []
        if isinstance(message, pb.Move):
            moves = [message.action]
            if max(message.state, message.next_state) >= states:
                raise LogError(identity.path, f"move {message.number} is not of a grid of {states} cells")
        if any(move >= MOVES for move in moves):
            raise LogError(identity.path, f"{max(moves)} is no move; there are {MOVES}, from 0")
