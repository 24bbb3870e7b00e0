"""How a trial ended, as its log says itself: the server's last word, and what every sender has sent.

The recorder writes two metadata records when it closes a log. `end` has the trial's state and a reason;
`sent` has "KEY EPOCH" -> the last sequence number, as its sender says. In lockstep the hub has every
process's whole output; in real time each process gives an account of what it sent as it leaves. A log
without them was cut short, or its server was killed. `received`, in real time only, has "ROBOT,... EPOCH KEY
SENDER'S-EPOCH" -> "MESSAGES BYTES": what reached each process of robots. `recovered` is in a log that
`swarm recover` made.

A later log of a trial has `before`: the last numbers that stand in the logs before it. So each of them can be
checked by itself.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

END, SENT, RECEIVED, RECOVERED = "end", "sent", "received", "recovered"
BEFORE, ACCOUNT = "before", "account"
COMPLETE = "complete"
CONTINUED = "continued"
"""Of a log that was closed before its trial was over: the next one goes on."""
KILLED = {"state": "interrupted", "reason": "its server was killed"}
"""What is put into the log of a server that could not say how the trial ended."""
MAX_NUMBER = 2**32 - 1
"""Sequence numbers have 32 bits in a log."""
Sender = tuple[str, int]
"""A key, and the epoch of the process that sends it."""


@dataclass(frozen=True)
class Receipt:
    """What one start of a process of robots has received under one key from one start of a sender."""

    robots: tuple[str, ...]
    epoch: int
    """Of the process; 0 in a lockstep, where it does not matter."""
    key: str
    sender: int
    messages: int
    bytes: int


def receipts_of(robots: tuple[str, ...], epoch: int, counts: Mapping[str, tuple[int, int]]) -> list[Receipt]:
    """Receipts of a process of robots, from its counts by "KEY EPOCH"; none of one that has no robots."""
    found = []
    for name, (messages, size) in counts.items() if robots else ():
        key, _, sender = name.rpartition(" ")
        if key and _is_number(sender):
            found.append(Receipt(robots, epoch, key, int(sender), messages, size))
    return found


@dataclass(frozen=True)
class Ending:
    """The last word of a log."""

    state: str = ""
    """COMPLETE, or what else became of the trial; empty if the log does not say."""
    reason: str = ""
    sent: Mapping[Sender, int] = field(default_factory=dict)
    """The last number of each sender that has given account."""
    receipts: tuple[Receipt, ...] = ()
    """What processes of robots have received, of those that have given account."""
    lost: str = ""
    """What `swarm recover` could not read of the log that this one was made of; empty if nothing."""

    @property
    def fault(self) -> str:
        """Why the trial is not known to have come to its end; empty if it is."""
        if self.lost:
            return f"recovered from a damaged log: {self.lost}"
        if not self.state:
            return "how the trial ended is not recorded: its server was killed, or the log is cut short"
        if self.state == CONTINUED:
            return "the trial goes on in a later log, which is not here"
        return "" if self.state == COMPLETE else f"the trial was {self.state}: {self.reason}"


def last_of(endings: Sequence[Ending]) -> Ending:
    """How a trial ended of which several servers recorded a log each: as the last says, with all accounts."""
    sent: dict[Sender, int] = {}
    for ending in endings:
        sent |= {sender: max(last, sent.get(sender, 0)) for sender, last in ending.sent.items()}
    lost = "; ".join(dict.fromkeys(ending.lost for ending in endings if ending.lost))
    receipts = tuple(receipt for ending in endings for receipt in ending.receipts)
    return replace(endings[-1], sent=sent, receipts=receipts, lost=lost)


def ending_of(metadata: Mapping[str, Mapping[str, str]]) -> Ending:
    """What the metadata of a log say of its end."""
    end = metadata.get(END, {})
    lost = metadata.get(RECOVERED, {}).get("lost", "")
    sent = numbers_of(metadata.get(SENT, {}))
    receipts = tuple(_receipts(metadata.get(RECEIVED, {})))
    return Ending(end.get("state", ""), end.get("reason", ""), sent, receipts, lost)


def numbers_of(record: Mapping[str, str]) -> dict[Sender, int]:
    """A number for each sender, from a metadata record; what makes no sense is left out."""
    numbers = {}
    for name, number in record.items():
        key, _, epoch = name.rpartition(" ")
        if key and _is_number(epoch) and _is_number(number) and int(number) <= MAX_NUMBER:
            numbers[key, int(epoch)] = int(number)
    return numbers


def numbers_record(numbers: Mapping[Sender, int]) -> dict[str, str]:
    """The metadata record of a number for each sender."""
    return {f"{key} {epoch}": str(number) for (key, epoch), number in sorted(numbers.items())}


def _receipts(record: Mapping[str, str]) -> Iterator[Receipt]:
    for name, counts in record.items():
        words, numbers = name.split(" "), counts.split(" ")
        if len(words) == 4 and len(numbers) == 2 and all(map(_is_number, (words[1], words[3], *numbers))):
            robots = tuple(words[0].split(","))
            messages, size = map(int, numbers)
            yield Receipt(robots, int(words[1]), words[2], int(words[3]), messages, size)


def ending_records(
    state: str, reason: str, sent: Mapping[Sender, int], receipts: Sequence[Receipt] = ()
) -> dict[str, dict[str, str]]:
    """The metadata records of an ending; nothing is said of receipts if there are none."""
    received = {
        f"{','.join(one.robots)} {one.epoch} {one.key} {one.sender}": f"{one.messages} {one.bytes}"
        for one in receipts
    }
    ending = {END: {"state": state, "reason": reason}, SENT: numbers_record(sent)}
    return ending | ({RECEIVED: received} if received else {})


def account_record(
    received: Mapping[Sender, int],
    last: Mapping[Sender, int],
    before: Mapping[Sender, int],
    recovered: Mapping[Sender, int],
) -> dict[str, str]:
    """The metadata record `account` of a log: for each sender how many of its messages are in it, how many of
    those this server has had to ask for so far, and how many are lost between the first and the last.
    """
    return {
        f"{sender[0]} {sender[1]}": json.dumps(
            {
                "received": received.get(sender, 0),
                "recovered": recovered.get(sender, 0),
                "lost": max(0, number - before.get(sender, 0) - received.get(sender, 0)),
            }
        )
        for sender, number in sorted(last.items())
    }


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdecimal() and len(text) < 20
