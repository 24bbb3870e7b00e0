"""A hash chain over the chunks of a trial's logs: each link holds a chunk and the link before it.

So a log vouches for every message in it and for their order, beyond what a checksum of 32 bits can, and a
later log of a trial for the one that it goes on from. The last link of a log stands in its metadata `chain`;
the one that it begins with, of a log that goes on from another, in `continues`. A link is SHA-256 over the
link before, as 64 hexadecimal digits (none for the first), and the records of the chunk, unpacked.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

CHAIN, CONTINUES = "chain", "continues"


class Chain:
    """Grows with every chunk, from a first link on that another log ended with."""

    def __init__(self, first: str = "") -> None:
        self.link = first
        self.chunks = 0

    def add(self, chunk: bytes) -> None:
        """The records of the next chunk."""
        self.link = hashlib.sha256(self.link.encode() + chunk).hexdigest()
        self.chunks += 1

    def record(self) -> dict[str, str]:
        """The metadata `chain`."""
        return {"sha256": self.link, "chunks": str(self.chunks)}


def first_link(metadata: Mapping[str, Mapping[str, str]]) -> str:
    """The link that a log says to go on from; empty if from none."""
    return metadata.get(CONTINUES, {}).get("sha256", "")


def last_link(metadata: Mapping[str, Mapping[str, str]]) -> str:
    """The link that a log ended with; empty if its recorder did not finish it."""
    return metadata.get(CHAIN, {}).get("sha256", "")
