"""What must not be lost is taken in once: senders repeat what a server may have missed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from swarm.clock import NS_PER_S
from swarm.logs.ending import Sender
from swarm.messages.header import Item
from swarm.messages.topics import Delivery, topic_of

LATE_NS = 2 * NS_PER_S
"""Later than the quickest of its sender by more than this, a message had been lost at first: a delay on the
way is a fraction of it."""


class Unheard:
    """Lets messages through that were not heard before; `last` has the last number of each sender in the logs
    that an earlier server left.

    A sender's numbers come in order, also those that it repeats.
    """

    def __init__(self, last: Mapping[Sender, int]) -> None:
        self._last = dict(last)
        self._quickest_ns: dict[int, int] = {}
        self.recovered: Counter[Sender] = Counter()
        """How many messages of each sender came only after they had been lost on their way."""

    def of(self, items: Iterable[Item], now_ns: int) -> list[Item]:
        """The new ones."""
        return [item for item in items if not must_not_be_lost(item.key) or self._is_new(item, now_ns)]

    def lacks(self, accounts: Mapping[Sender, int]) -> bool:
        """Whether a sender of what must not be lost has sent more than was heard."""
        return any(
            must_not_be_lost(sender[0]) and last > self._last.get(sender, 0)
            for sender, last in accounts.items()
        )

    def _is_new(self, item: Item, now_ns: int) -> bool:
        sender, (epoch, sequence, t_ns) = (item.key, item.header.epoch), item.header
        if sequence <= self._last.get(sender, 0):
            return False
        self._last[sender] = sequence
        delay_ns = now_ns - t_ns
        quickest_ns = min(delay_ns, self._quickest_ns.get(epoch, delay_ns))
        self._quickest_ns[epoch] = quickest_ns
        self.recovered[sender] += delay_ns - quickest_ns > LATE_NS
        return True


def must_not_be_lost(key: str) -> bool:
    """Whether every message of a key counts."""
    found = topic_of(key)
    return found is not None and found[0].delivery is Delivery.EVERY
