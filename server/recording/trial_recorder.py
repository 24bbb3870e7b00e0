"""The log of a trial: a file, and another one when the first has reached its size or its time, or when the
disk had no more room.

Every file is closed whole and can be read alone: what was said once stands in each of them. While the disk
has no room nothing that must not be lost is lost: it waits in memory, and whoever conducts the trial pauses
it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from google.protobuf.message import Message

from server.hubs.hub import Batch
from server.recording.latched import LatchedState
from server.recording.recorder import LeftOut, Recorder
from swarm.checkup.machine import free_bytes, lack_of_room
from swarm.clock import NS_PER_S
from swarm.config.experiment import LogSettings
from swarm.errors import RunFailedError, UserError, in_words
from swarm.logs.chain import CONTINUES, last_link
from swarm.logs.ending import ACCOUNT, CONTINUED, Receipt, Sender, account_record
from swarm.logs.reader import LogError, LogReader
from swarm.logs.recover import close_log
from swarm.logs.trial_logs import closed_path, open_path
from swarm.messages.topics import VIEW_ARENA, Delivery, topic_of

About = Callable[[int], Mapping[str, Mapping[str, str]]]
"""The metadata of a part."""
Accounts = Mapping[Sender, int] | None
"""The last number of each sender by its own account; None if the hub had everything that was sent."""
MB = 1_000_000
S_PER_H = 3600
MORE_BYTES = 16 << 20
"""Beyond the reserve, before a trial that lacked room goes on: else it would stop again at once."""


class TrialRecorder:
    """Records one trial from its part number `first_part` on; `path_of` says where each part goes.

    `recovered` tells how many messages of each sender came only after they had been lost on their way.
    """

    def __init__(
        self,
        path_of: Callable[[int], Path],
        about: About,
        settings: LogSettings,
        latched: LatchedState,
        first_part: int = 1,
        free: Callable[[Path], int] = free_bytes,
        recovered: Callable[[], Mapping[Sender, int]] = dict,
    ) -> None:
        self._path_of = path_of
        self._about = about
        self._most_bytes = round(settings.file_mb * MB)
        self._most_ns = round(settings.file_h * S_PER_H * NS_PER_S)
        self._latched = latched
        self._free = free
        self._recovered = recovered
        self._part = first_part - 1
        """The number of the file that was begun last."""
        self._unflushed: list[Batch] = []
        """What a file that cannot be written any more would lack."""
        self._arena: Message | None = None
        self._t_ns = self._began_ns = 0
        self._is_due = False
        """Whether what comes next goes into another file."""
        self._messages = 0
        self._disk_error = ""
        self._abandoned: Path | None = None
        """The file that the disk took no more of."""
        self.left_out = LeftOut()
        self.waits_for = ""
        """What keeps the trial from being recorded; empty while it is."""
        self._recorder: Recorder | None = self._opened()

    @property
    def messages(self) -> int:
        """Recorded so far."""
        return self._messages + (self._recorder.messages if self._recorder else 0)

    @property
    def disk_error(self) -> str:
        """Why the disk could not take the log at some time; empty if it always could."""
        return self._disk_error or (self._recorder.disk_error if self._recorder else "")

    def write(self, batch: Batch) -> None:
        """Append a batch; its order is the log's order."""
        self._began_ns = self._began_ns or batch.t_ns
        self._t_ns = batch.t_ns
        if self._is_due and batch.items:
            self._end_file("the file is large or old enough")
            self._go_on()
        for item in batch.items:
            self._latched.heard(item.key, item.payload)
        if self._recorder is None:
            batch = self._kept(batch)
        self._unflushed.append(batch)
        self._try(lambda recorder: recorder.write(batch))

    def write_view(self, topic: str, message: Message, t_ns: int) -> None:
        """Append a message for viewers; nobody misses it while the disk is full."""
        if topic == VIEW_ARENA:
            self._arena = message
        self._try(lambda recorder: recorder.write_view(topic, message, t_ns))

    def flush(self) -> None:
        """Hand everything to the operating system. What comes next goes into another file if this one is
        large or old enough; nothing is recorded while there is too little room.
        """
        if self._recorder is None:
            self._go_on()
            return
        self._try(Recorder.flush)
        if self._recorder:
            self._latched.finished(self._recorder.last)
            self._unflushed.clear()
            self._look_at_limits(self._recorder)

    def end(self, state: str, reason: str, accounts: Accounts, receipts: Sequence[Receipt] = ()) -> None:
        """Write how the trial ended, and what every sender has sent by its own account."""
        if self._recorder is None:
            self._go_on(reserve=False)
        if self._recorder:
            self._latched.finished(self._recorder.last)
        sent = self._latched.last if accounts is None else accounts
        self._try(lambda recorder: self._end(recorder, state, reason, sent, receipts))

    def close(self) -> None:
        """Write the index, and give the file its name; a second call does nothing."""
        self._try(Recorder.close)
        recorder, self._recorder = self._recorder, None
        if recorder:
            self._messages += recorder.messages
            self._disk_error = self._disk_error or recorder.disk_error
            recorder.path.rename(closed_path(recorder.path))

    def _look_at_limits(self, recorder: Recorder) -> None:
        is_old = self._t_ns - self._began_ns >= self._most_ns
        self._is_due = is_old or recorder.size_bytes >= self._most_bytes
        lack = lack_of_room(recorder.path.parent, self._free)
        if lack:
            self._end_file(lack)
            self.waits_for = lack

    def _end_file(self, reason: str) -> None:
        self._try(lambda recorder: self._end(recorder, CONTINUED, reason, {}))
        self.close()
        self._is_due = False

    def _end(
        self,
        recorder: Recorder,
        state: str,
        reason: str,
        sent: Mapping[Sender, int],
        receipts: Sequence[Receipt] = (),
    ) -> None:
        """The ending, and the account of this file."""
        recorder.end(state, reason, sent, receipts)
        account = account_record(recorder.received(), recorder.last, self._before, self._recovered())
        recorder.add_metadata(ACCOUNT, account)

    def _go_on(self, *, reserve: bool = True) -> None:
        """Begin the next file, if there is room for one, with what it has to hold."""
        place = self._path_of(self._part + 1).parent
        lack = lack_of_room(place, self._free, MORE_BYTES) if reserve else ""
        try:
            if not lack:
                self._close_abandoned()
                self._recorder = self._opened()
        except (OSError, RunFailedError, UserError) as error:
            lack = str(error)
        self.waits_for = lack
        if self._recorder is None:
            return
        if self._arena is not None:
            self.write_view(VIEW_ARENA, self._arena, self._t_ns)
        self._try(self._write_unflushed)

    def _close_abandoned(self) -> None:
        """Close the file that the disk took no more of; one without a message goes, and leaves its number."""
        if self._abandoned is None:
            return
        close_log(self._abandoned, {"state": CONTINUED, "reason": "the disk took no more"})
        if not closed_path(self._abandoned).exists():
            self._part -= 1
        self._abandoned = None

    def _write_unflushed(self, recorder: Recorder) -> None:
        for batch in self._unflushed:
            recorder.write(batch)

    def _opened(self) -> Recorder:
        self._before = dict(self._latched.last)
        part = self._part + 1
        latched = self._latched.records() | self._continues() if part > 1 else {}
        self._began_ns = self._t_ns
        path = open_path(self._path_of(part))
        recorder = Recorder(path, {**self._about(part), **latched}, left_out=self.left_out)
        self._part = part
        return recorder

    def _continues(self) -> dict[str, dict[str, str]]:
        """Which file the next one goes on from, by its hash chain."""
        before = self._path_of(self._part)
        try:
            return {CONTINUES: {"log": before.name, "sha256": last_link(LogReader(before).read_metadata())}}
        except LogError:
            return {}

    def _try(self, work: Callable[[Recorder], None]) -> None:
        """Do something with the open file; if the disk refuses, the file stays as it was flushed last."""
        if self._recorder is None:
            return
        try:
            work(self._recorder)
        except OSError as error:
            recorder, self._recorder = self._recorder, None
            self.waits_for = self._disk_error = in_words(error)
            self._messages += recorder.messages
            recorder.abandon()
            self._abandoned = recorder.path

    def _kept(self, batch: Batch) -> Batch:
        """What of a batch must not be lost."""
        kept = []
        for item in batch.items:
            found = topic_of(item.key)
            if found and found[0].delivery is Delivery.EVERY:
                kept.append(item)
            elif found and found[0].logged:
                self.left_out.while_paused[item.key] += 1
        return Batch(batch.t_ns, kept)
