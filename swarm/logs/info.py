"""What an MCAP file holds, whoever wrote it: topics, times, how it ended, and whose run it is.

An index whose checksum is right says it at once. Without one the file is read from front to back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from swarm.clock import NS_PER_S
from swarm.errors import UserError
from swarm.files import printable
from swarm.logs.ending import ending_of
from swarm.logs.reader import LogChannel, LogReader, nothing
from swarm.logs.trial_logs import OPEN_SUFFIX

CLOSED, OPEN, DAMAGED = "closed", "open", "damaged"


class TopicInfo(NamedTuple):
    """The messages of one topic, those of all its senders' starts together."""

    messages: int
    schema: str
    encoding: str


@dataclass(frozen=True)
class LogInfo:
    """What is known of a log without decoding a message."""

    path: Path
    topics: Mapping[str, TopicInfo]
    start_t_ns: int | None
    """When the first message was received; None if there is none."""
    end_t_ns: int | None
    by_index: bool
    """Whether the index says it. Then the data themselves have not been looked at."""
    state: str = CLOSED
    """DAMAGED, or OPEN: being written, or left by a writer that was killed, or cut short."""
    damage: Sequence[str] = ()
    metadata: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def messages(self) -> int:
        """Of all topics."""
        return sum(topic.messages for topic in self.topics.values())

    @property
    def duration_s(self) -> float:
        """From the first message to the last."""
        if self.start_t_ns is None or self.end_t_ns is None:
            return 0.0
        return (self.end_t_ns - self.start_t_ns) / NS_PER_S

    def rate_hz(self, topic: str) -> float | None:
        """The mean over the whole log; None if the log takes no time."""
        return self.topics[topic].messages / self.duration_s if self.duration_s > 0 else None

    def as_json(self) -> dict[str, Any]:
        return {
            "log": printable(self.path),
            "messages": self.messages,
            "start_t_ns": self.start_t_ns,
            "end_t_ns": self.end_t_ns,
            "duration_s": self.duration_s,
            "state": self.state,
            "by": "index" if self.by_index else "scan",
            "damage": list(self.damage),
            "topics": {
                name: {**topic._asdict(), "rate_hz": self.rate_hz(name)}
                for name, topic in self.topics.items()
            },
            "run": self.run,
            "trial_ended": self.trial_ended,
        }

    @property
    def run(self) -> dict[str, Any] | None:
        """Which trial of which run, as the log's recorder has it; None for a log of another program."""
        said = self.metadata.get("run")
        if said is None:
            return None
        numbers = {name: int(text) if text.isdecimal() else text for name, text in said.items()}
        commit = self.metadata.get("versions", {}).get("commit")
        changes = self.metadata.get("experiment", {}).get("set", "").splitlines()
        return {**numbers, "commit": commit, "robots": dict(self.metadata.get("robots", {})), "set": changes}

    @property
    def trial_ended(self) -> dict[str, str] | None:
        """The state in which the trial ended, and why; None if the log does not say."""
        ending = ending_of(self.metadata)
        return {"state": ending.state, "reason": ending.reason} if ending.state else None


def read_info(path: Path) -> LogInfo:
    """What a log holds; LogError for what is no MCAP file, or damaged without a message left."""
    return _by_index(path) or _by_scan(path)


def logs_named(places: Iterable[Path]) -> list[Path]:
    """Files as they are, and of directories every .mcap file in them; UserError for a directory without."""
    found = []
    for place in places:
        logs = _logs_below(place) if place.is_dir() else [place]
        if not logs:
            raise UserError(f"{place}: holds no log (*.mcap); is it a run directory?")
        found += logs
    return found


def _logs_below(directory: Path) -> list[Path]:
    """Those that are being written, too."""
    return sorted(path for pattern in ("*.mcap", f"*.mcap{OPEN_SUFFIX}") for path in directory.glob(pattern))


def _by_index(path: Path) -> LogInfo | None:
    """None if there is no index, or one that does not vouch for everything that is asked."""
    reader = LogReader(path)
    statistics = reader.read_index()
    if statistics is None:
        return None
    counts = statistics.channel_message_counts
    if counts.keys() - reader.channels.keys() or sum(counts.values()) != statistics.message_count:
        return None
    times = (statistics.message_start_time, statistics.message_end_time)
    start_t_ns, end_t_ns = times if statistics.message_count else (None, None)
    topics = _topics(reader.channels.values(), counts)
    return LogInfo(path, topics, start_t_ns, end_t_ns, by_index=True, metadata=reader.metadata)


def _by_scan(path: Path) -> LogInfo:
    reader, counts = LogReader(path, nothing), Counter[int]()
    starts, ends = [], []
    for part in reader.parts():
        counts[part.channel.id] += len(part.sequence)
        starts.append(int(part.receive_t_ns.min()))
        ends.append(int(part.receive_t_ns.max()))
    return LogInfo(
        path,
        _topics(reader.channels.values(), counts),
        min(starts),
        max(ends),
        by_index=False,
        state=_state(reader),
        damage=list(map(str, reader.damage)),
        metadata=reader.metadata,
    )


def _state(reader: LogReader) -> str:
    """A file that merely stops is one that nobody has closed."""
    if not reader.damage:
        return CLOSED
    stops = len(reader.damage) == 1 and reader.damage[0].messages == reader.messages
    return OPEN if stops and reader.recorded_messages is None else DAMAGED


def _topics(channels: Iterable[LogChannel], counts: Mapping[int, int]) -> dict[str, TopicInfo]:
    """By name; a key that several starts of its sender used is one topic."""
    found: dict[str, TopicInfo] = {}
    for channel in sorted(channels, key=lambda channel: (channel.key, channel.id)):
        before = found[channel.key].messages if channel.key in found else 0
        count = before + counts.get(channel.id, 0)
        found[channel.key] = TopicInfo(count, channel.schema, channel.encoding)
    return found
