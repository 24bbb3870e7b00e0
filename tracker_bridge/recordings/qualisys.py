"""Qualisys: QTM's TSV export of bodies with 6 degrees of freedom, and tables of points, in millimetres.

A body's columns are X Y Z, three angles, a residual and Rot[0] to Rot[8], the rotation matrix column by
column. The angles depend on settings of the project, so the matrix is what is read. A table of points has
columns NAME_x, NAME_y, NAME_z and a `timestamp`, as pandas writes QTM's stream.
"""

from __future__ import annotations

import math
from datetime import datetime

from swarm.clock import NS_PER_S
from tracker_bridge.backends.bodies import Body
from tracker_bridge.protocols.cursor import Quaternion
from tracker_bridge.recordings.recording import Moment, Recording, Rows, number, numbers, vector

UNIT_M = 0.001
BODY_COLUMNS = 16
RESIDUAL, MATRIX = 6, 7


def is_bodies(rows: Rows) -> bool:
    return any(row[:1] == ["BODY_NAMES"] for row in rows[:30])


def read_bodies(rows: Rows) -> Recording:
    head = next(line for line, row in enumerate(rows) if any(cell.endswith(" X") for cell in row))
    settings = {row[0]: row[1:] for row in rows[:head] if row}
    rate_hz = float(settings["FREQUENCY"][0])
    first = next(column for column, cell in enumerate(rows[head]) if cell.endswith(" X"))
    names = [name for name in settings["BODY_NAMES"] if name]
    moments = []
    for line, row in enumerate(rows[head + 1 :]):
        places = ((name, first + BODY_COLUMNS * each) for each, name in enumerate(names))
        bodies = [body for name, column in places if (body := _body(name, row, column))]
        moments.append(Moment(round(line * NS_PER_S / rate_hz), bodies))
    return Recording(UNIT_M, moments)


def is_points(rows: Rows) -> bool:
    return bool(rows) and "timestamp" in rows[0] and any(cell.endswith("_x") for cell in rows[0])


def read_points(rows: Rows) -> Recording:
    time = rows[0].index("timestamp")
    places = {cell.removesuffix("_x"): column for column, cell in enumerate(rows[0]) if cell.endswith("_x")}
    moments = [
        Moment(
            _time_ns(row[time]),
            [Body(name, seen, None) for name, column in places.items() if (seen := vector(row, column))],
        )
        for row in rows[1:]
    ]
    return Recording(UNIT_M, moments)


def _time_ns(text: str) -> int:
    moment = datetime.fromisoformat(text)
    return int(moment.timestamp()) * NS_PER_S + moment.microsecond * 1_000


def _body(name: str, row: list[str], column: int) -> Body | None:
    position, matrix = vector(row, column), numbers(row, column + MATRIX, 9)
    if position is None or matrix is None or not any(matrix):
        return None
    residual_mm = number(row, column + RESIDUAL) or 0.0
    return Body(name, position, _quaternion(matrix), residual_mm * UNIT_M)


def _quaternion(matrix: tuple[float, ...]) -> Quaternion:
    """Of a rotation matrix, column by column; by the largest of four parts, which is never 0."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = matrix
    parts = (1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz)
    rows = (
        (parts[0], xy + yx, xz + zx, yz - zy),
        (xy + yx, parts[1], yz + zy, zx - xz),
        (xz + zx, yz + zy, parts[2], xy - yx),
        (yz - zy, zx - xz, xy - yx, parts[3]),
    )
    largest = rows[max(range(4), key=lambda each: parts[each])]
    length = math.hypot(*largest)
    x, y, z, w = (part / length for part in largest)
    return x, y, z, w
