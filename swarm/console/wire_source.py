"""The messages of a run that goes on, heard by an observer who says nothing."""

from __future__ import annotations

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.console.run_history import SHOWN, About, RunHistory
from swarm.console.sources import take_in
from swarm.errors import UserError
from swarm.logs.follow import Timed
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import RUN_IDENTITY, topic_of
from swarm.messages.validation import BadMessageError, decode
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import ALIVE_SERVER
from swarm.runtime.zenoh_session import Inbox, PresenceWatch, Session, SessionSettings, WireSample

ANSWER_WITHIN_S = 1.0
"""A server on the other side of a bad radio link answers within a tenth of this."""
AHEAD_NS = 2 * NS_PER_S
"""A sender's time may be so far ahead of the newest state of the run, which comes once a second."""
POLLS_BETWEEN_TRIES = 50
"""While nobody answers: a second."""
MOST_HELD = 10_000
"""Messages that wait for the run's first state, which tells what time it is: a second of a large swarm."""


class Listening:
    """One session: the server's presence, and an inbox for every topic that is shown."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._watch: PresenceWatch = session.presence_watch(ALIVE_SERVER)
        self._servers: set[str] = set()
        self._inboxes: list[Inbox] = []

    def identity(self) -> RunIdentity | None:
        """Whose run it is, as the server says; None if none answers."""
        answers = self._session.ask(RUN_IDENTITY, ANSWER_WITHIN_S)
        try:
            return RunIdentity.unpack(answers[0]) if answers else None
        except ValueError as error:
            raise UserError(
                f"the server's identity cannot be read ({error}): is it of this version?"
            ) from error

    def listen(self) -> None:
        """From now on every topic's messages are kept for `samples`."""
        self._inboxes = [
            self._session.inbox(topic.key("*"), topic.delivery, keep_all=True)
            for topic in sorted(SHOWN, key=lambda topic: topic.pattern)
        ]

    @property
    def is_alone(self) -> bool:
        """Whether no server is present."""
        for key, is_there in self._watch.poll():
            (self._servers.add if is_there else self._servers.discard)(key)
        return not self._servers

    def samples(self) -> list[WireSample]:
        return [sample for inbox in self._inboxes for sample in inbox.poll()]

    def close(self) -> None:
        self._session.close()


class WireSource:
    """Hears a live run, and the next one at the same address when that has ended."""

    is_live = True
    is_read = False

    def __init__(self, settings: SessionSettings) -> None:
        self._settings = settings
        self._listening: Listening | None = None
        self._history: RunHistory | None = None
        self._run_id = ""
        self._now_ns: int | None = None
        """The newest time of the run's state: the clock that everything is put in order by."""
        self._held: list[Timed] = []
        self._polls_to_wait = 0
        self.state = f"waiting for the server at {settings.endpoint}"

    @property
    def history(self) -> RunHistory | None:
        return self._history

    def poll(self) -> bool:
        if self._listening is None:
            self._try_to_join()
            return False
        is_alone = self._listening.is_alone  # Asked first: what the server said last is there already.
        self._take_in(self._listening.samples())
        if self._listening and is_alone:
            self._leave(f"the server at {self._settings.endpoint} is gone: waiting for it")
        return False

    def close(self) -> None:
        if self._listening:
            self._listening.close()

    def _try_to_join(self) -> None:
        """Once a second, until a server answers whose run this is."""
        self._polls_to_wait -= 1
        if self._polls_to_wait > 0:
            return
        self._polls_to_wait = POLLS_BETWEEN_TRIES
        try:
            session = Session(self._settings)
        except UserError as error:
            self.state = f"waiting: {error}"
            return
        listening = Listening(session)
        identity = listening.identity()
        if identity is None:
            listening.close()
            return
        listening.listen()
        self._listening = listening
        self._begin(identity)

    def _begin(self, identity: RunIdentity) -> None:
        """A history for this run, or the one that it has already."""
        if self._history is None or identity.run_id != self._run_id:
            experiment = Experiment.of_settings(f"the run at {self._settings.endpoint}", identity.settings)
            about = About(self._settings.endpoint, identity.trial, identity.program, identity.run_id)
            self._history, self._run_id = RunHistory(experiment, about), identity.run_id
            self._now_ns = None
        self.state = f"connected to {self._settings.endpoint}"

    def _leave(self, state: str) -> None:
        assert self._listening
        self._listening.close()
        self._listening, self.state = None, state

    def _take_in(self, samples: list[WireSample]) -> None:
        assert self._history
        for sample in samples:
            header = Header.unpack(sample.attachment)
            if header is None or topic_of(sample.key) is None:
                continue
            if sample.key == topics.RUN_STATE.pattern and not self._heard_state(header, sample.payload):
                self._leave("another run begins")
                return
            self._held.append((header.t_ns, Item(sample.key, header, sample.payload)))
        del self._held[:-MOST_HELD]
        if self._now_ns is not None:
            latest_ns = self._now_ns + AHEAD_NS
            found = sorted((min(t_ns, latest_ns), item) for t_ns, item in self._held)
            self._held = []
            take_in(self._history, found)

    def _heard_state(self, header: Header, payload: bytes) -> bool:
        """Whether the state is of the run that this history is of."""
        try:
            state = decode(pb.RunState, payload)
        except BadMessageError:
            return True
        self._now_ns = max(self._now_ns or 0, header.t_ns)
        return state.run_id == self._run_id
