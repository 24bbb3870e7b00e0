"""What an audit of a trial's firewall comes to: what crossed between robots, by kind, and a verdict."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.files import printable


@dataclass(frozen=True)
class Crossing:
    """Bytes of one robot, or of nobody known, that reached another under a key."""

    source: str
    robot: str
    key: str
    messages: int
    bytes: int

    def __str__(self) -> str:
        amount = f"{self.bytes:,} bytes in {self.messages:,} messages"
        return f"{self.robot} received {amount} of {self.source} under {self.key}"


@dataclass
class FirewallAudit:
    """What was found in a trial."""

    path: Path
    robots: list[str]
    observed: list[Crossing] = field(default_factory=list)
    """What simulated cameras were shown of others: light, in place of what a lens sees."""
    permitted: list[Crossing] = field(default_factory=list)
    """Internal state that the experiment lets a robot read."""
    violations: list[Crossing] = field(default_factory=list)
    """What nobody permitted."""
    unexplained: list[str] = field(default_factory=list)
    """Paths that came from nowhere, and messages that their sender does not know of."""
    unproven: list[str] = field(default_factory=list)
    """Why nothing can be said of a robot."""
    refusals: list[str] = field(default_factory=list)
    """What the hub did not let into the run."""
    remarks: list[str] = field(default_factory=list)

    @property
    def faults(self) -> list[str]:
        """What crossed although it must not."""
        return [*map(str, self.violations), *self.unexplained]

    @property
    def holds(self) -> bool:
        """Whether it is shown that nothing crossed but observation, and what the experiment permits."""
        return not (self.faults or self.unproven)

    @property
    def verdict(self) -> str:
        """In one line."""
        if self.faults:
            return "; ".join(self.faults)
        if self.unproven:
            return f"not shown: {'; '.join(self.unproven)}"
        if self.permitted:
            what = "; ".join(map(str, self.permitted))
            return f"nothing but observation crossed, and the access that the experiment permits: {what}"
        pairs = len(self.robots) * (len(self.robots) - 1)
        return f"nothing but observation crossed between {len(self.robots)} robots: 0 bytes in {pairs} pairs"

    def pairs(self) -> dict[tuple[str, str], dict[str, int]]:
        """Bytes from a robot to another: what was shown, what was permitted, and what was neither."""
        found = {(a, b): dict.fromkeys(KINDS, 0) for a in self.robots for b in self.robots if a != b}
        for kind, crossings in zip(KINDS, (self.observed, self.permitted, self.violations), strict=True):
            for one in crossings:
                counts = found.setdefault((one.source, one.robot), dict.fromkeys(KINDS, 0))
                counts[kind] += one.bytes
        return found

    def as_json(self) -> dict[str, Any]:
        pairs = [{"from": a, "to": b, **counts} for (a, b), counts in self.pairs().items()]
        return {
            "log": printable(self.path),
            "holds": self.holds,
            "verdict": self.verdict,
            "bytes": pairs,
            "faults": self.faults,
            "permitted": [*map(str, self.permitted)],
            "unproven": self.unproven,
            "refused_by_the_hub": self.refusals,
            "remarks": self.remarks,
        }


KINDS = ("observed", "permitted", "other")
"""Of bytes that crossed."""
