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


def is_it(rows: Rows) -> bool:
    return bool(rows) and len(rows[0]) == COLUMNS and all(_is_number(cell) for cell in rows[0])


def read(rows: Rows) -> Recording:
    return Recording(UNIT_M, [_moment(row) for row in rows if row])


def _moment(row: list[str]) -> Moment:
    robot, time, x, y, z, _ = row
    return Moment(int(Decimal(time) * NS_PER_S), [Body(robot, (float(x), float(y), float(z)), None)])


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).removeprefix("-").isdigit()
