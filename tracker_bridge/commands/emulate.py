"""`tracker-bridge emulate SYSTEM`: a tracking system that is not there."""

from __future__ import annotations

import argparse

from tracker_bridge.commands import emulate_camera


def add_arguments(parser: argparse.ArgumentParser) -> None:
    systems = parser.add_subparsers(dest="system", required=True, metavar="camera")
    emulate_camera.add_arguments(systems.add_parser("camera", help="a camera above robots with tags"))


def run(arguments: argparse.Namespace) -> None:
    emulate_camera.run(arguments)
