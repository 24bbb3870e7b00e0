"""The only file that imports zenoh: a hub and clients with explicit endpoints.

Inboxes are polled from the main loop. Only the lockstep, where every wake-up counts, is called on arrival.
"""

from __future__ import annotations

import atexit
import ctypes
import json
import os
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from swarm.access.credentials import zenoh_values
from swarm.access.tls_check import check_certificates
from swarm.errors import UserError
from swarm.messages.topics import Delivery
from swarm.runtime.background import in_background
from swarm.runtime.endpoint import check_endpoint, check_protection

if TYPE_CHECKING:
    import zenoh
    from zenoh.ext import AdvancedPublisher, AdvancedSubscriber

    Samples = zenoh.handlers.Handler[zenoh.Sample]

ONE_THREAD = (
    "(rx:(handover:app),tx:(handover:app),acc:(handover:app),net:(handover:app),app:(worker_threads:1))"
)
"""Three threads in place of seven, and a lockstep of ten processes a fifth faster (measured). A hub that
strangers reach keeps the seven: with one, who makes it wait would make everybody wait."""
QUEUE_DEPTH = 65_536
"""Messages; fifty robots send some thousand a second: room for more than half a minute."""
NEWEST_KEPT = 64
"""Of a key of which the newest counts: were it one, who sends what nobody believes would push it out."""
MOST_AT_ONCE = 4096
"""Messages of an inbox in one poll: some tenths of a second of work on a board, then the others' turn."""
QUESTIONS_WAITING = 256
"""Of one key: a main loop answers them ten times a second; who asks more often waits for Zenoh."""
LARGEST_MESSAGE_BYTES = 16 << 20
"""What a session takes in: thrice an exchange of 1000 robots in lockstep. Zenoh would put 1 GiB together
before anybody could refuse it."""
HEARTBEAT_S = 0.5
"""After a publisher's last message it says so often, for a while, what its number was."""
WAIT_FOR_ROOM_S = 5.0
"""What must not be dropped waits so long for room, or as long as the lease; then Zenoh reconnects."""


@dataclass(frozen=True)
class SessionSettings:
    """How a process reaches the others.

    The hub listens on `endpoint` (tls/HOST:PORT or, on one machine, tcp/127.0.0.1:PORT or
    unixsock-stream/FILE) and routes; clients connect to it and keep trying.
    `config` is a Zenoh configuration file (JSON5) whose values come first. `credentials` is an identity's
    folder, as `swarm lab keys` makes it; without it nothing that another machine can reach is opened unless
    `insecure` says so. `limits` are more of Zenoh's settings by their place, for a hub that strangers reach.
    """

    endpoint: str
    hub: bool = False
    lease_s: float = 1.5
    """Silence after which a peer counts as gone: long for a gap in the radio, short for a person."""
    wait_for_hub: bool = True
    config: Path | None = None
    credentials: Path | None = None
    insecure: bool = False
    limits: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class WireSample:
    """What arrived: key, payload, and the bytes beside it."""

    key: str
    payload: bytes
    attachment: bytes


class Inbox:
    """Samples of one subscription, polled by the main loop."""

    def __init__(self, subscriber: zenoh.Subscriber[Samples] | AdvancedSubscriber[Samples]) -> None:
        self._subscriber = subscriber

    def poll(self, most: int = MOST_AT_ONCE) -> list[WireSample]:
        """What has arrived since the last call, in order; of more than `most` the rest comes next."""
        samples: list[WireSample] = []
        while len(samples) < most and (sample := self._subscriber.try_recv()) is not None:
            samples.append(_sample(sample))
        return samples


class Question:
    """What somebody asks under a key, until it is answered."""

    def __init__(self, key: str, query: zenoh.Query) -> None:
        self._key = key
        self._query = query
        self.payload = bytes(query.payload) if query.payload is not None else b""

    def answer(self, payload: bytes) -> None:
        """Answer it, once."""
        with self._query:
            self._query.reply(self._key, payload)


class Questions:
    """What is asked under one key, polled by the main loop."""

    def __init__(self, key: str, queryable: zenoh.Queryable[zenoh.handlers.Handler[zenoh.Query]]) -> None:
        self._key = key
        self._queryable = queryable

    def poll(self) -> list[Question]:
        """What has been asked since the last call, in order."""
        asked: list[Question] = []
        while len(asked) < MOST_AT_ONCE and (query := self._queryable.try_recv()) is not None:
            asked.append(Question(self._key, query))
        return asked


class PresenceWatch:
    """The presence keys that have appeared and vanished, polled by the main loop."""

    def __init__(self, subscriber: zenoh.Subscriber[Samples]) -> None:
        self._subscriber = subscriber

    def poll(self) -> list[tuple[str, bool]]:
        """Since the last call, in order: each key, and whether it is there now."""
        changes = []
        while (sample := self._subscriber.try_recv()) is not None:
            changes.append((str(sample.key_expr), str(sample.kind).endswith("PUT")))
        return changes


class Put(Protocol):
    """Sends a payload, with bytes beside it."""

    def __call__(self, payload: bytes, *, attachment: bytes | None = None) -> None: ...


class Publisher:
    """Puts payloads under one key."""

    def __init__(self, publisher: zenoh.Publisher | AdvancedPublisher) -> None:
        self.put: Put = publisher.put
        """Zenoh's own, without a call in between, which would show in the pace of a lockstep."""


ZENOH_SAYS = "error,zenoh::api::session=off"
"""A session that closes calls it an error that messages were still on their way to it."""


class Session:
    """A Zenoh session, closed at the end of its block or of the process.

    To open one may take for ever where the server is not there yet: `waiting` is called once a second
    meanwhile, and signals are obeyed.
    """

    def __init__(self, settings: SessionSettings, waiting: Callable[[], None] = lambda: None) -> None:
        if not settings.limits:
            os.environ.setdefault("ZENOH_RUNTIME", ONE_THREAD)
        import zenoh
        import zenoh.ext

        zenoh.init_log_from_env_or(ZENOH_SAYS)
        self.endpoint = settings.endpoint
        self._zenoh = zenoh
        self._tokens: list[zenoh.LivelinessToken] = []
        self._listening: list[zenoh.Subscriber[None]] = []
        self._answering: list[zenoh.Queryable[None]] = []
        self._recovering: list[AdvancedSubscriber[Samples]] = []
        try:
            self._session = in_background(partial(_opened, settings), waiting)
        except zenoh.ZError as error:
            raise UserError(_why_not_open(settings, str(error))) from error
        atexit.register(self.close)

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Undeclare everything and leave; presence tokens vanish for the others.

        Zenoh gives up after a while if another side does not read: there is nothing that is left to do then.
        """
        atexit.unregister(self.close)
        if not self._session.is_closed():
            with suppress(self._zenoh.ZError):
                while self._recovering:  # Left declared, they would keep the process alive.
                    self._recovering.pop().undeclare()  # type: ignore[no-untyped-call]
                self._session.close()  # type: ignore[no-untyped-call]

    def publisher(self, key: str, delivery: Delivery) -> Publisher:
        """A publisher with the delivery's guarantees."""
        control = self._zenoh.CongestionControl
        priorities = {
            Delivery.BULK: self._zenoh.Priority.DATA_LOW,
            Delivery.URGENT: self._zenoh.Priority.REAL_TIME,
        }
        return Publisher(
            self._session.declare_publisher(
                key,
                congestion_control=control.BLOCK if delivery is Delivery.EVERY else control.DROP,
                priority=priorities.get(delivery, self._zenoh.Priority.DATA),
                express=delivery is Delivery.URGENT,
            )
        )

    def keeping_publisher(self, key: str, depth: int) -> Publisher:
        """A publisher that keeps the newest for a `recovering_inbox`; they talk under keys of `RECOVERY`."""
        ext = self._zenoh.ext
        return Publisher(
            ext.declare_advanced_publisher(
                self._session,
                key,
                congestion_control=self._zenoh.CongestionControl.BLOCK,
                cache=ext.CacheConfig(max_samples=depth),
                sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT_S),
                publisher_detection=True,
            )
        )

    def recovering_inbox(self, key: str, depth: int) -> Inbox:
        """As `inbox_of_others`, and asks a `keeping_publisher` for what it missed, in that one's order."""
        ext = self._zenoh.ext
        subscriber = ext.declare_advanced_subscriber(
            self._session,
            key,
            self._zenoh.handlers.RingChannel(depth),
            allowed_origin=self._zenoh.Locality.REMOTE,
            history=ext.HistoryConfig(detect_late_publishers=True),
            recovery=ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
        )
        self._recovering.append(subscriber)
        return Inbox(subscriber)

    def inbox(self, key: str, delivery: Delivery, *, keep_all: bool = False) -> Inbox:
        """Subscribe to a key expression.

        Of a `NEWEST` delivery the last few samples are kept, unless `keep_all` says that the expression
        holds many keys.
        """
        handlers = self._zenoh.handlers
        newest_only = delivery is Delivery.NEWEST and not keep_all
        channel = handlers.RingChannel(NEWEST_KEPT) if newest_only else handlers.FifoChannel(QUEUE_DEPTH)
        return Inbox(self._session.declare_subscriber(key, channel))

    def inbox_of_others(self, key: str, depth: int) -> Inbox:
        """The newest messages that other sessions send under a key, `depth` of them: who sends more than is
        taken in loses its own older ones, and nobody waits."""
        return Inbox(
            self._session.declare_subscriber(
                key,
                self._zenoh.handlers.RingChannel(depth),
                allowed_origin=self._zenoh.Locality.REMOTE,
            )
        )

    def on_arrival(self, key: str, receive: Callable[[bytes], None]) -> None:
        """Call `receive` with every payload, for as long as this session lives.

        It is called on Zenoh's own thread, or on that of a sender in the same session. Meanwhile the
        session neither receives nor sends, and what it raises Zenoh only prints: it must be quick or the
        session's only work, must not wait for Zenoh, and must keep its errors.
        """
        known: set[int] = set()

        def call(sample: zenoh.Sample) -> None:
            thread = threading.get_ident()
            if thread not in known:
                known.add(thread)
                _keep_python_state()
            receive(sample.payload.to_bytes())

        handler = self._zenoh.handlers.Callback(call, indirect=False)
        self._listening.append(self._session.declare_subscriber(key, handler))

    def declare_alive(self, key: str) -> None:
        """Show presence under a key for as long as this session lives."""
        self._tokens.append(self._session.liveliness().declare_token(key))

    def arrivals(self, key: str) -> Inbox:
        """The presence keys that match a key expression, now and as they come; they come again as they go."""
        channel: zenoh.handlers.FifoChannel[zenoh.Sample] = self._zenoh.handlers.FifoChannel(QUEUE_DEPTH)
        return Inbox(self._session.liveliness().declare_subscriber(key, channel, history=True))

    def answer(self, key: str, payload: bytes) -> None:
        """Answer everyone who asks for a key with the same bytes, for as long as this session lives."""
        self._answering.append(self._session.declare_queryable(key, lambda query: query.reply(key, payload)))

    def questions(self, key: str) -> Questions:
        """What others ask under a key, to be answered from the main loop."""
        channel: zenoh.handlers.FifoChannel[zenoh.Query] = self._zenoh.handlers.FifoChannel(QUESTIONS_WAITING)
        return Questions(key, self._session.declare_queryable(key, channel))

    def ask(self, key: str, within_s: float, payload: bytes | None = None) -> list[bytes]:
        """What those answer who know the key."""
        target = self._zenoh.QueryTarget.ALL
        replies = self._session.get(key, target=target, timeout=within_s, payload=payload)
        return [bytes(reply.ok.payload) for reply in replies if reply.ok is not None]

    def alive(self, key: str) -> list[str]:
        """The presence keys that match a key expression now."""
        replies = self._session.liveliness().get(key)
        return sorted({str(reply.ok.key_expr) for reply in replies if reply.ok is not None})

    def presence_watch(self, key: str) -> PresenceWatch:
        """Watch the presence keys that match an expression: first those that are there already."""
        channel: zenoh.handlers.FifoChannel[zenoh.Sample] = self._zenoh.handlers.FifoChannel(QUEUE_DEPTH)
        return PresenceWatch(self._session.liveliness().declare_subscriber(key, channel, history=True))


def _opened(settings: SessionSettings) -> zenoh.Session:
    import zenoh

    check_endpoint(settings.endpoint)
    check_protection(settings.endpoint, bool(settings.credentials or settings.config), settings.insecure)
    config = _config(settings)
    if settings.credentials and not settings.hub:
        check_certificates(settings.endpoint, settings.credentials)
    return zenoh.open(config)


def _keep_python_state() -> None:
    """Let this foreign thread keep what Python knows of it.

    Python would make that anew for every callback, which takes longer than the callback. One call
    without its release keeps it (C API, "Non-Python created threads").
    """
    ctypes.pythonapi.PyGILState_Ensure()


def _sample(sample: zenoh.Sample) -> WireSample:
    attachment = sample.attachment
    return WireSample(
        str(sample.key_expr), bytes(sample.payload), bytes(attachment) if attachment is not None else b""
    )


def _config(settings: SessionSettings) -> zenoh.Config:
    """Scouting, gossip and shared memory off: explicit endpoints only, and nothing lost in /dev/shm."""
    import zenoh

    config = _config_of(settings.config) if settings.config else zenoh.Config()
    patience_s = max(settings.lease_s, WAIT_FOR_ROOM_S)
    secret = zenoh_values(settings.credentials, settings.hub) if settings.credentials else {}
    values: dict[str, object] = {
        "mode": "router" if settings.hub else "client",
        "listen/endpoints": [settings.endpoint] if settings.hub else [],
        "connect/endpoints": [] if settings.hub else [settings.endpoint],
        "connect/timeout_ms": -1 if settings.wait_for_hub and not settings.hub else 0,
        "connect/exit_on_failure": not settings.wait_for_hub,
        "connect/retry": {"period_init_ms": 100, "period_max_ms": 1000, "period_increase_factor": 2},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/link/rx/max_message_size": LARGEST_MESSAGE_BYTES,
        "timestamping/enabled": True,
        "transport/link/tx/lease": round(settings.lease_s * 1000),
        "transport/link/tx/queue/congestion_control/block/wait_before_close": round(patience_s * 1e6),
        **settings.limits,
        **secret,
    }
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return config


def _config_of(file: Path) -> zenoh.Config:
    import zenoh

    try:
        return zenoh.Config.from_file(str(file))
    except zenoh.ZError as error:
        raise UserError(f"{file}: no Zenoh configuration ({_reason(str(error))})") from error


def _reason(error: str) -> str:
    """The first words of a Zenoh error, without the place in Zenoh's own source."""
    return " ".join(error.partition(" at /")[0].split())[:120]


def _why_not_open(settings: SessionSettings, error: str) -> str:
    reason = _reason(error)
    if settings.hub:
        cure = "is another server running there, or is the address not this machine's?"
        return f"cannot listen on {settings.endpoint}: {cure} ({reason})"
    return f"cannot reach the server at {settings.endpoint}: is it running? ({reason})"
