"""A NatNet packet as plain values, for people and for scripts."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from tracker_bridge.protocols.natnet import MessageId, Version, parse_server_info, split
from tracker_bridge.protocols.natnet_frame import Frame, parse_frame
from tracker_bridge.protocols.natnet_models import parse_models


def decoded_packet(data: bytes, version: Version) -> dict[str, Any]:
    """What a packet says, or at least its kind and size. DatagramError if it is none."""
    number, payload = split(data)
    if number == MessageId.FRAME:
        return {"message": "frame"} | _frame(parse_frame(payload, version))
    if number == MessageId.MODEL_DEFINITIONS:
        models = asdict(parse_models(payload, version))
        return {"message": "model definitions"} | models | {"bodies": list(models["bodies"].values())}
    if number == MessageId.SERVER_INFO:
        return {"message": "server info"} | asdict(parse_server_info(payload)) | {"bytes_left": 0}
    known = number in {*map(int, MessageId)}
    name = MessageId(number).name.lower().replace("_", " ") if known else str(number)
    return {"message": name, "payload_bytes": len(payload)}


def _frame(frame: Frame) -> dict[str, Any]:
    """Its bodies and markers under the names that a reader looks for."""
    values = asdict(frame)
    values["bodies"] = values.pop("rigid_bodies")
    values["markers"] = values.pop("labelled_markers")
    return values
