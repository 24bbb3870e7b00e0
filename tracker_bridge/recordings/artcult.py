"""The tracker's log of the original laboratory (the artificial culture project): one robot a line.

    robot,unix time,x,y,z,status

The project's page says millimetres; robots would then drive 0.5 m/s, four times as fast as they can. The unit
is 0.1 mm.
"""

from __future__ import annotations

from decimal import Decimal

from swarm.clock import NS_PER_S
from tracker_bridge.backends.bodies import Body
from tracker_bridge.recordings.recording import Moment, Recording, Rows

UNIT_M = 0.0001
COLUMNS = 6
LATEST_S = Decimal(2**63 // NS_PER_S)
"""The year 2262, where 64 bits of nanoseconds end."""


def is_it(rows: Rows) -> bool:
    return bool(rows) and len(rows[0]) == COLUMNS and all(_is_number(cell) for cell in rows[0])


def read(rows: Rows) -> Recording:
    return Recording(UNIT_M, [_moment(row) for row in rows if row])


def _moment(row: list[str]) -> Moment:
    robot, time, x, y, z, _ = row
    return Moment(_time_ns(time), [Body(robot, (float(x), float(y), float(z)), None)])


def _time_ns(text: str) -> int:
    """In full, which a float's 53 bits do not hold; ValueError if it is no date that a log can have."""
    time_s = Decimal(text)
    if not 0 <= time_s <= LATEST_S:
        raise ValueError(f"{text[:20]!r} is no time")
    return int(time_s * NS_PER_S)


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).removeprefix("-").isdigit()
