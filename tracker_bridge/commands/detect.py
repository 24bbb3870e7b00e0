"""`tracker-bridge detect PICTURE --tags 36h11`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from tracker_bridge.overhead.annotation import annotated, save_picture
from tracker_bridge.overhead.frames import read_picture
from tracker_bridge.overhead.tags import FAMILIES, Tag, TagDetector, TagFamily


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("picture", type=Path, metavar="PICTURE")
    parser.add_argument("--tags", required=True, metavar="FAMILY", help=", ".join(sorted(FAMILIES)))
    parser.add_argument("--ids", type=int, nargs="+", metavar="ID", help="report no others")
    parser.add_argument("--json", action="store_true", help="print them for a program")
    parser.add_argument(
        "--out", type=Path, metavar="FILE.png", help="save the picture with the tags drawn in"
    )


def run(arguments: argparse.Namespace) -> None:
    picture = read_picture(arguments.picture)
    tags = sorted(TagDetector(TagFamily(arguments.tags, arguments.ids)).find(picture), key=lambda tag: tag.id)
    if arguments.out:
        save_picture(arguments.out, annotated(picture, tags))
    if arguments.json:
        print(json.dumps({"tags": [_for_a_program(tag) for tag in tags]}))
        return
    for tag in tags:
        u, v = tag.corners.mean(0)
        print(f"tag {tag.id} at ({u:.1f}, {v:.1f}) px, agreement with its code {tag.agreement:.2f}")
    if not tags:
        print("no tags")


def _for_a_program(tag: Tag) -> dict[str, object]:
    corners = [[round(float(u), 3), round(float(v), 3)] for u, v in tag.corners]
    return {"id": tag.id, "corners": corners, "agreement": round(tag.agreement, 3)}
