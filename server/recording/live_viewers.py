"""A run in Foxglove or Lichtblick while it goes on: what the log gets is sent to whoever looks on.

The protocol is Foxglove's WebSocket (subprotocol foxglove.sdk.v1). Viewers say nothing to the run, and the
run does not wait for them: who is slow misses the oldest of what is still to be sent.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from foxglove import Channel, Context, Schema, start_server
from foxglove.websocket import ChannelView, Client, ServerListener, WebSocketServer
from google.protobuf.message import Message

from server.hubs.hub import Batch
from server.recording.recorder import descriptor_set
from swarm.errors import UserError
from swarm.messages.topics import VIEW_ARENA, topic_of
from swarm.runtime.endpoint import is_loopback

MOST_WAITING = 1024
"""Messages that wait for one viewer: some seconds of a small swarm, and a few hundred kilobytes."""
MOST_CHANNELS = 2000
"""50 robots have 1000 keys; what somebody makes up beyond that is for the log's account, not for viewers."""


class LiveViewers(ServerListener):  # type: ignore[misc, unused-ignore]  # untyped where the extra is missing
    """A channel for every key that is logged, and for every view, with the schema that the log has."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self._channels: dict[str, Channel | None] = {}
        self._arena: tuple[bytes, int] | None = None

    def write(self, batch: Batch) -> None:
        """Send a batch's messages as they came, to those who want them."""
        for key, _, payload in batch.items:
            if key not in self._channels:
                self._channels[key] = self._of_key(key)
            channel = self._channels[key]
            if channel and channel.has_sinks():
                channel.log(payload, log_time=batch.t_ns)

    def write_view(self, topic: str, message: Message, t_ns: int) -> None:
        """Send a message that the server made for viewers."""
        channel = self._channels.get(topic) or self._opened(topic, type(message))
        self._channels[topic] = channel
        payload = message.SerializeToString()
        if topic == VIEW_ARENA:
            self._arena = payload, t_ns
        channel.log(payload, log_time=t_ns)

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002
        """The arena is drawn once, and so again for whoever comes later."""
        opened = self._channels.get(channel.topic)
        if channel.topic == VIEW_ARENA and opened and self._arena:
            payload, t_ns = self._arena
            opened.log(payload, log_time=t_ns)

    def _of_key(self, key: str) -> Channel | None:
        found = topic_of(key)
        if found is None or not found[0].logged or len(self._channels) >= MOST_CHANNELS:
            return None
        return self._opened(key, found[0].message)

    def _opened(self, topic: str, message: type[Message]) -> Channel:
        descriptor = message.DESCRIPTOR
        data = descriptor_set(descriptor.file).SerializeToString(deterministic=True)
        schema = Schema(name=descriptor.full_name, encoding="protobuf", data=data)
        return Channel(topic, schema=schema, message_encoding="protobuf", context=self.context)


@contextmanager
def live_viewers(address: str, *, insecure: bool) -> Iterator[LiveViewers]:
    """Serve viewers at HOST:PORT; UserError if nobody may or can be served there."""
    viewers = LiveViewers(Context())
    try:
        if not insecure and not is_loopback(address):
            raise UserError(
                f"--live {address}: whoever reaches it can look on: name 127.0.0.1 as the host, or add "
                f"--insecure on a network of your own"
            )
        server = _started(address, viewers)
    except (OSError, UnicodeError, RuntimeError) as error:
        raise UserError(f"--live {address}: {error}; choose another HOST:PORT") from error
    try:
        yield viewers
    finally:
        server.stop()


def _started(address: str, viewers: LiveViewers) -> WebSocketServer:
    """It runs in threads of its own, without Python's lock."""
    host, _, port = address.rpartition(":")
    return start_server(
        name="swarm-server",
        host=host.strip("[]"),
        port=int(port),
        server_listener=viewers,
        context=viewers.context,
        message_backlog_size=MOST_WAITING,
    )
