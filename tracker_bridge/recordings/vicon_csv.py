"""Vicon Tracker 3's CSV export: a byte-order mark, CRLF, and for each object a rotation and a place.

Its RX, RY, RZ are a rotation *vector*, the axis times the angle, which may be longer than pi.

    Objects
    100
    ,,Global Angle r1:r1,,,,,,...
    Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,...
    ,,rad,rad,rad,mm,mm,mm,...
"""

from __future__ import annotations

import math

from swarm.clock import NS_PER_S
from tracker_bridge.arena_frame import from_rotation_vector
from tracker_bridge.backends.bodies import Body
from tracker_bridge.recordings.recording import Moment, Recording, Rows, vector

TITLES = ("Objects", "Segments")
NAMES, UNITS, FIRST = 2, 4, 5
"""Lines, counted from 0."""
COLUMNS = 6
"""Of one object: three of rotation, then three of place."""
METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0}
RADIANS = {"rad": 1.0, "deg": math.pi / 180.0}


def is_it(rows: Rows) -> bool:
    return len(rows) >= FIRST and rows[0][:1] != [] and rows[0][0].strip() in TITLES


def read(rows: Rows) -> Recording:
    rate_hz = float(rows[1][0])
    names = {column: _name(text) for column, text in enumerate(rows[NAMES]) if text.strip()}
    radians = RADIANS[rows[UNITS][2].strip()]
    unit_m = METRES[rows[UNITS][5].strip()]
    moments = [
        Moment(
            round(float(row[0]) * NS_PER_S / rate_hz),
            [body for column, name in names.items() if (body := _body(name, row, column, radians))],
        )
        for row in rows[FIRST:]
        if row and row[0].strip()
    ]
    return Recording(unit_m, moments)


def _name(text: str) -> str:
    """ "Global Angle r1:r1" is r1."""
    return text.strip().removeprefix("Global Angle ").partition(":")[0]


def _body(name: str, row: list[str], column: int, radians: float) -> Body | None:
    """None where the object was lost: its cells are blank, or all zero."""
    turned, position = vector(row, column), vector(row, column + 3)
    if turned is None or position is None or not any((*turned, *position)):
        return None
    x, y, z = turned
    return Body(name, position, from_rotation_vector((x * radians, y * radians, z * radians)))
