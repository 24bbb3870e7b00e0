"""OptiTrack Motive's CSV export of rigid bodies: cells stay blank where a body is lost.

The first line tells the units; the columns are described by lines named Type, Name, ID (the position of each
varies with the version), and by the two lines that end with the one that begins with Frame.
"""

from __future__ import annotations

from dataclasses import dataclass

from swarm.clock import NS_PER_S
from swarm.errors import UserError
from tracker_bridge.backends.bodies import Body
from tracker_bridge.recordings.recording import Moment, Recording, Rows, number, numbers, vector

METRES = {"Meters": 1.0, "Centimeters": 0.01, "Millimeters": 0.001}


@dataclass(frozen=True)
class _Columns:
    name: str
    rotation: int
    position: int
    error: int | None


def is_it(rows: Rows) -> bool:
    return bool(rows) and rows[0][:1] == ["Format Version"]


def read(rows: Rows) -> Recording:
    settings = dict(zip(rows[0][::2], rows[0][1::2], strict=False))
    rotation = settings.get("Rotation Type", "Quaternion")
    if rotation != "Quaternion":
        raise UserError(f"rotations are {rotation}: export them as Quaternion")
    head = next(line for line, row in enumerate(rows) if row[:1] == ["Frame"])
    columns = _columns(rows, head)
    unit_m = METRES[settings.get("Length Units", "Meters")]
    moments = [_moment(row, columns, unit_m) for row in rows[head + 1 :] if row and row[0].strip()]
    return Recording(unit_m, moments)


def _columns(rows: Rows, head: int) -> list[_Columns]:
    labelled = {row[1].strip(): row for row in rows[1:head] if len(row) > 1}
    kinds, names, parts = labelled["Type"], labelled["Name"], rows[head - 1]
    places: dict[str, dict[str, int]] = {}
    for column in range(2, len(names)):
        if kinds[column].strip() == "Rigid Body":
            places.setdefault(names[column].strip(), {}).setdefault(parts[column].strip(), column)
    return [
        _Columns(name, found["Rotation"], found["Position"], _error_column(found))
        for name, found in places.items()
        if {"Rotation", "Position"} <= set(found)
    ]


def _error_column(found: dict[str, int]) -> int | None:
    return found.get("Mean Marker Error", found.get("Error Per Marker"))


def _moment(row: list[str], columns: list[_Columns], unit_m: float) -> Moment:
    bodies = [body for each in columns if (body := _body(row, each, unit_m))]
    return Moment(round(float(row[1]) * NS_PER_S), bodies)


def _body(row: list[str], columns: _Columns, unit_m: float) -> Body | None:
    rotation, position = numbers(row, columns.rotation, 4), vector(row, columns.position)
    if rotation is None or position is None:
        return None
    x, y, z, w = rotation
    error = number(row, columns.error) if columns.error is not None else None
    return Body(columns.name, position, (x, y, z, w), unit_m * (error or 0.0))
