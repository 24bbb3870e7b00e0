"""The firewall between robots, audited: what crossed in a trial besides observation, by three witnesses.

Every process of robots tells what reached it, key by key and sender by sender. The log tells who those
senders are, and how much they sent. And every path that a robot remembers has to come from its own camera or
from the experiment. Section 2.4's access to another's internal state is no observation: it needs the
experiment's permission (a robot's `accesses`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment
from swarm.logs.crossings import Crossing, FirewallAudit
from swarm.logs.ending import Ending, Receipt, receipts_of
from swarm.logs.identity import LogIdentity
from swarm.logs.reader import LogChannel, LogReader, Part
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Role, Topic, topic_of
from swarm.messages.validation import BadMessageError, decode
from swarm.runtime.receipts import read_receipts

OWN = (topics.POSE, topics.ORDER, topics.RUN_STATE, topics.ESTOP, topics.CARRY, topics.VIEW)
"""What a robot is sent under its own id, or everybody: a simulated one also its view and its places."""
SOMEBODY = "somebody who takes no part"
REFUSALS = ("refused", "duplicate", "flood")
"""Events by which the hub tells of what it did not let into the run."""
WITNESSES = (topics.PATH, topics.OBSERVATION, topics.SERVER_EVENT)


def audit(parts: list[LogIdentity]) -> FirewallAudit:
    """Of one trial, from all of its logs; LogError for what is no log of a run."""
    log = _Log()
    readers = [log.read(part.path) for part in parts]
    experiment = Experiment.of_log(str(parts[0].path), readers[0].metadata["experiment"]["toml"], {})
    ending = parts[0].ending
    receipts = ending.receipts or tuple(_written(parts[0]))
    found = FirewallAudit(parts[0].path, [robot.id for robot in experiment.robot])
    judge = _Judge(experiment, log, ending, found)
    for receipt in receipts:
        judge.hear(receipt)
    found.unproven += _silent(found.robots, receipts, log)
    found.unexplained += log.paths_from_nowhere(experiment)
    found.refusals += log.refusals
    shared = sorted({receipt.robots for receipt in receipts if len(receipt.robots) > 1})
    found.remarks += [
        f"{', '.join(each)} share a process: what crosses inside does not show" for each in shared
    ]
    return found


@dataclass
class _Log:
    """What a trial's logs tell of senders, and of where paths come from."""

    starts: dict[str, set[int]] = field(default_factory=dict)
    """Robot -> the epochs of its processes."""
    epochs: set[int] = field(default_factory=set)
    """Of everybody who took part."""
    paths: list[tuple[str, pb.PathRemembered]] = field(default_factory=list)
    windows: dict[tuple[str, int], list[int]] = field(default_factory=dict)
    """Robot and visit -> the moves that its camera gave it."""
    refusals: list[str] = field(default_factory=list)

    def read(self, path: Path) -> LogReader:
        """Take in a log."""
        reader = LogReader(path, _is_witness)
        for part in reader.parts():
            self._take_in(part.channel, part)
        return reader

    def robots_of(self, epoch: int) -> list[str]:
        """The robots of a process; of no process if the epoch is nobody's."""
        return [robot for robot, epochs in self.starts.items() if epoch in epochs]

    def paths_from_nowhere(self, experiment: Experiment) -> Iterator[str]:
        """Every path that a robot remembers although neither its camera nor the experiment gave it."""
        for robot, path in self.paths:
            if not self._is_explained(experiment, robot, path):
                yield f"{robot} remembers path {path.path}: neither its camera nor the experiment gave it"

    def _is_explained(self, experiment: Experiment, robot: str, path: pb.PathRemembered) -> bool:
        settings = experiment.robot_named(robot)
        if path.source == "camera":
            return self.windows.get((robot, path.visit)) == list(path.moves)
        if path.source == "given":
            return list(path.moves) in [list(map(int, given.moves)) for given in settings.given_paths()]
        return path.source == "access" and bool(settings.accesses)

    def _take_in(self, channel: LogChannel, part: Part) -> None:
        topic = channel.topic
        if topic is None:
            return
        self.epochs.add(channel.epoch)
        if topic.sender is Role.ROBOT and topic is not topics.TRUTH:
            self.starts.setdefault(channel.publisher, set()).add(channel.epoch)
        for message in _decoded(topic, part.payloads):
            if isinstance(message, pb.PathRemembered):
                self.paths.append((channel.publisher, message))
            elif isinstance(message, pb.Observation):
                self.windows[channel.publisher, message.visit] = list(message.window)
            elif isinstance(message, pb.Event) and message.name in REFUSALS:
                self.refusals.append(message.text)


@dataclass
class _Judge:
    """Sorts what processes received."""

    experiment: Experiment
    log: _Log
    ending: Ending
    found: FirewallAudit

    def hear(self, receipt: Receipt) -> None:
        """Of no interest, observed, permitted, or a violation."""
        topic, named = topic_of(receipt.key) or (None, "")
        robot = named if named in receipt.robots else "+".join(receipt.robots)
        crossing = Crossing(
            self._source(receipt, topic, named), robot, receipt.key, receipt.messages, receipt.bytes
        )
        if topic in OWN and named in ("", *receipt.robots) and not crossing.source:
            self._expected(receipt, topic, robot)
        elif topic is topics.BEST_MOVES and self._may_read(receipt.robots, named):
            self.found.permitted.append(crossing)
        else:
            self.found.violations.append(crossing)

    def _expected(self, receipt: Receipt, topic: Topic[Any] | None, robot: str) -> None:
        """What a robot is to be sent, unless it got more of it than was sent."""
        if topic is topics.VIEW:
            watched = self.experiment.robot_named(robot).watches
            self.found.observed.append(Crossing(watched, robot, receipt.key, receipt.messages, receipt.bytes))
        last = self.ending.sent.get((receipt.key, receipt.sender))
        if last is not None and receipt.messages > last:
            received = f"{robot} received {receipt.messages:,} messages under {receipt.key}"
            self.found.unexplained.append(f"{received}, of which their sender knows {last:,}")

    def _may_read(self, robots: Iterable[str], named: str) -> bool:
        return any(self.experiment.robot_named(robot).accesses == named for robot in robots)

    def _source(self, receipt: Receipt, topic: Topic[Any] | None, named: str) -> str:
        """Which robot sent it; "" if it was server, tracker or operator, or the robot's own process.

        In a lockstep, which nobody joins, everybody has the same epoch: there a key tells its sender.
        """
        if topic is not None and topic.sender is Role.ROBOT:
            return "" if named in receipt.robots else named
        if topic is topics.ESTOP or len(self.log.epochs) == 1:
            return ""
        senders = self.log.robots_of(receipt.sender)
        if senders:
            return "" if set(senders) & set(receipt.robots) else "+".join(senders)
        return "" if receipt.sender in self.log.epochs else SOMEBODY


def _is_witness(channel: LogChannel) -> bool:
    return channel.topic in WITNESSES


def _decoded(topic: Topic[Any], payloads: Iterable[bytes]) -> Iterator[Any]:
    for payload in payloads:
        try:
            yield decode(topic.message, payload)
        except BadMessageError:
            continue


def _silent(robots: Iterable[str], receipts: Iterable[Receipt], log: _Log) -> Iterator[str]:
    """Robots, or starts of their processes, that gave no account of what reached them."""
    told: dict[str, set[int]] = {}
    for receipt in receipts:
        for robot in receipt.robots:
            told.setdefault(robot, set()).add(receipt.epoch)
    for robot in robots:
        silent = log.starts.get(robot, set()) - told.get(robot, set())
        if robot not in told:
            yield f"{robot} gave no account of what it received"
        elif silent and told[robot] != {0}:
            yield f"{robot} gave no account of what it received in {len(silent)} of its starts"


def _written(log: LogIdentity) -> Iterator[Receipt]:
    """What the processes of a simulated trial wrote down beside their output."""
    for file in sorted((log.path.parent / "output" / log.path.stem).glob("*.keys")):
        try:
            robots, counts = read_receipts(file)
        except (OSError, ValueError):
            continue
        yield from receipts_of(robots, 0, counts)
