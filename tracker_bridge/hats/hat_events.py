"""What is told about hats beside where they are: losses, swaps, missing pins, stray reflections."""

from __future__ import annotations

from dataclasses import dataclass, field

from swarm.clock import NS_PER_S
from tracker_bridge.hats.bodies import Body
from tracker_bridge.hats.patterns import Hat

PIN_LOST_NS = NS_PER_S
"""With 5 % of markers missing at random, 100 clouds in a row without one never happen."""
SAME_PLACE_M = 0.05
"""A robot that is found within its own radius of where another was last has taken its place."""


@dataclass(frozen=True)
class HatEvent:
    """Something to tell: "named", "lost", "doubted", "twice", "swap", "missing pin", "ambiguous" (three
    markers that several hats share) or "stray reflection"."""

    kind: str
    text: str
    hats: tuple[str, ...] = ()


@dataclass
class HatHistory:
    """Where hats were last and what was told of them."""

    hats: list[Hat]
    _last_place: dict[int, complex] = field(default_factory=dict)
    _place_of: dict[int, int] = field(default_factory=dict)
    """Whose last place a hat was found at."""
    _told: set[tuple[str, int, int]] = field(default_factory=set)

    def named(self, hat: int, place: complex) -> list[HatEvent]:
        """A hat was recognised at a place; it and another have swapped if each is where the other was."""
        name = self.hats[hat].name
        events = [HatEvent("named", f"hat {name} is at {_at(place)}", (name,))]
        own = self._last_place.get(hat)
        for other, last in self._last_place.items():
            if other != hat and own is not None and abs(last - place) < SAME_PLACE_M < abs(own - place):
                self._place_of[hat] = other
                if self._place_of.get(other) == hat:
                    names = tuple(sorted((self.hats[other].name, name)))
                    events.append(
                        HatEvent("swap", f"hats {names[0]} and {names[1]} have swapped places", names)
                    )
                    del self._place_of[hat], self._place_of[other]
        return events

    def left(self, hat: int, place: complex, why: str) -> HatEvent:
        """A named hat is followed no more: "lost", or "doubted" because its markers no longer fit."""
        self._last_place[hat] = place
        name = self.hats[hat].name
        reason = "is not seen" if why == "lost" else "no longer has its pattern"
        return HatEvent(why, f"hat {name} {reason} at {_at(place)}", (name,))

    def twice(self, hat: int, place: complex) -> list[HatEvent]:
        """A group of markers shows a hat that is followed elsewhere."""
        name = self.hats[hat].name
        text = f"hat {name} is seen a second time, at {_at(place)}: do two robots wear it?"
        return [HatEvent("twice", text, (name,))] if self._first_time(("twice", hat, 0)) else []

    def ambiguous(self, hat: int, place: complex) -> list[HatEvent]:
        """A group of three markers is seen for long, and more than one hat may have lost its fourth."""
        name = self.hats[hat].name
        text = f"three markers at {_at(place)} are hat {name} or another hat without a pin: set the pin again"
        return [HatEvent("ambiguous", text, (name,))] if self._first_time(("ambiguous", hat, 0)) else []

    def pins(self, body: Body, seen: list[bool], t_ns: int) -> list[HatEvent]:
        """Notice pins of a named body that have long not been seen."""
        assert body.hat is not None
        events = []
        for pin, is_seen in enumerate(seen):
            if is_seen:
                body.pin_seen_ns[pin] = t_ns
                self._told.discard(("pin", body.hat, pin))
            elif t_ns - body.pin_seen_ns[pin] > PIN_LOST_NS and self._first_time(("pin", body.hat, pin)):
                name = self.hats[body.hat].name
                text = f"hat {name}: pin {pin + 1} has not been seen for {PIN_LOST_NS / NS_PER_S:g} s"
                events.append(HatEvent("missing pin", text, (name,)))
        return events

    def _first_time(self, what: tuple[str, int, int]) -> bool:
        first = what not in self._told
        self._told.add(what)
        return first


def stray(place: complex) -> HatEvent:
    """A point that belongs to no hat and stays."""
    return HatEvent("stray reflection", f"a point at {_at(place)} belongs to no hat and does not move")


def _at(place: complex) -> str:
    return f"({place.real:.3f}, {place.imag:.3f}) m"
