"""Makes a damaged log whole: all that can be read of it, in a new file with an index and checksums."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Message, Metadata, Schema

from swarm.errors import RunFailedError
from swarm.files import new_file
from swarm.logs.chain import CHAIN
from swarm.logs.ending import END, KILLED, RECOVERED
from swarm.logs.mcap_chunks import places
from swarm.logs.mcap_records import BROKEN, BrokenRecordError, FramingError, Record, decoded
from swarm.logs.mcap_walk import Walk
from swarm.logs.mcap_writer import LogWriter
from swarm.logs.reader import Damage, Definitions, LogError, open_log
from swarm.logs.trial_logs import closed_path


@dataclass(frozen=True)
class Recovery:
    """What came of a log: the messages in the new file, and why what is missing could not be read."""

    messages: int
    lost: list[Damage]

    @property
    def is_cut(self) -> bool:
        """Whether nothing is missing but what would have followed: as of a log whose writer was killed."""
        return all(damage.messages == self.messages for damage in self.lost)


def close_log(left: Path, end: Mapping[str, str] = KILLED) -> None:
    """Close the log that a killed server left open: all of it that is whole, in a file of its own name.

    `end` is what is said of how it ended, unless it says so itself. The open file goes, unless it is damaged
    in its midst. RunFailedError if there is no room.
    """
    whole = closed_path(left)
    if not whole.exists():
        beside = whole.with_name(f".{whole.name}.closing")
        beside.unlink(missing_ok=True)
        try:
            recovery = recover_log(left, beside, end)
        except LogError:  # The server was killed in its first moment: it holds no message.
            left.unlink()
            return
        beside.rename(whole)
        if not recovery.is_cut:
            left.rename(whole.with_name(f"{whole.name}.damaged"))
            return
    left.unlink()


def recover_log(damaged: Path, whole: Path, end: Mapping[str, str] | None = None) -> Recovery:
    """Copy every record that can be read; of a damaged chunk nothing is copied.

    `end` is for a log whose writer is known to have stopped: how it ended, and that it stops is no damage.
    LogError for what is no log or holds no message that can be read, UserError if `whole` cannot be made,
    RunFailedError if there is no room for it.
    """
    with open_log(damaged) as source:
        target = new_file(whole)
        try:
            with target:
                return _recovered(damaged, source, target, end)
        except BaseException as error:
            whole.unlink()
            if isinstance(error, OSError):
                raise RunFailedError(f"{whole}: cannot be written ({error.strerror})") from error
            raise


def _recovered(damaged: Path, source: BinaryIO, target: BinaryIO, end: Mapping[str, str] | None) -> Recovery:
    copy = _Copy(target)
    try:
        copy.take_all(source)
    except FramingError as error:
        raise LogError(damaged, str(error)) from error
    if copy.messages == 0:
        reason = f": {copy.lost[0]}" if copy.lost else ""
        raise LogError(damaged, f"no message can be read from this log{reason}")
    copy.finish(end)
    target.flush()
    os.fsync(target.fileno())
    return copy.recovery


class _Copy:
    """The new log while it is written."""

    def __init__(self, target: BinaryIO) -> None:
        self.messages = 0
        self.lost: list[Damage] = []
        self._definitions = Definitions()
        self._metadata: dict[str, list[Metadata]] = {}
        self._writer = LogWriter(target)

    def take_all(self, source: BinaryIO) -> None:
        """Every record; FramingError for what is no log.

        A sound index is believed where it repeats schemas and channels, because a single one of them has no
        checksum. A damaged index is not asked.
        """
        walk = Walk(source, self._lose)
        self._add([*walk.index.definitions] if walk.index.verified else [])
        for record in walk.records():
            self._take(record)

    @property
    def recovery(self) -> Recovery:
        """What has come of the log so far."""
        return Recovery(self.messages, self.lost)

    def finish(self, end: Mapping[str, str] | None) -> None:
        """Say in the log itself what could not be read, and write the index."""
        if end is not None and END not in self._metadata:
            self._writer.add_metadata(END, dict(end))
        if self.lost and (end is None or not self.recovery.is_cut):
            about = {"lost": f"{len(self.lost)} places could not be read, the first: {self.lost[0]}"}
            self._writer.add_metadata(RECOVERED, about)
        self._writer.finish()

    def _take(self, record: Record) -> None:
        """All of a record, or nothing if any of it makes no sense."""
        try:
            found = list(_contents(record))
            self._check(found)
            self._add(found)
        except BROKEN as error:
            self._lose(record.offset_bytes, str(error))

    def _check(self, found: list[object]) -> None:
        """BrokenRecordError for a definition that contradicts an earlier one, or a message without one."""
        schemas, channels = {0, *self._writer.schemas}, set(self._writer.channels)
        for one in found:
            if isinstance(one, Schema | Channel):
                self._definitions.check(one)
            if isinstance(one, Schema):
                schemas.add(one.id)
            elif isinstance(one, Channel):
                channels.add(one.id)
                if one.schema_id not in schemas:
                    raise BrokenRecordError(f"schema {one.schema_id} of channel {one.id} is not defined")
            elif isinstance(one, Message) and one.channel_id not in channels:
                raise BrokenRecordError(f"a message of channel {one.channel_id}, which is not defined")

    def _add(self, found: list[object]) -> None:
        writer = self._writer
        for one in found:
            if isinstance(one, Message):
                writer.add_message(one.channel_id, one.log_time, one.data, one.publish_time, one.sequence)
                self.messages += 1
            elif isinstance(one, Schema) and self._definitions.add(one):
                writer.add_schema(one.id, one.name, one.encoding, one.data)
            elif isinstance(one, Channel) and self._definitions.add(one):
                about = dict(one.metadata)
                writer.add_channel(one.id, one.topic, one.message_encoding, one.schema_id, about)
            elif isinstance(one, Metadata) and one.name == CHAIN:
                continue  # The new log has other chunks, and a chain of its own.
            elif isinstance(one, Metadata) and one not in self._metadata.setdefault(one.name, []):
                self._metadata[one.name].append(one)
                writer.add_metadata(one.name, dict(one.metadata))
            elif isinstance(one, Attachment):
                writer.add_attachment(one.log_time, one.create_time, one.name, one.media_type, one.data)

    def _lose(self, offset_bytes: int, reason: str) -> None:
        self.lost.append(Damage(offset_bytes, self.messages, reason))


def _contents(record: Record) -> Iterator[object]:
    """What a record holds: one, or all of a chunk."""
    if record.opcode == Opcode.CHUNK:
        for opcode, body, end in places(record.body):
            yield decoded(opcode, record.body[body:end])
    elif record.opcode == Opcode.ATTACHMENT and not record.body:
        raise BrokenRecordError("an attachment is too large to be copied")
    else:
        yield decoded(record.opcode, record.body)
