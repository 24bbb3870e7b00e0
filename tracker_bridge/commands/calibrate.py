"""`tracker-bridge calibrate SYSTEM`: where a tracking system stands over the arena."""

from __future__ import annotations

import argparse

from tracker_bridge.commands import calibrate_camera


def add_arguments(parser: argparse.ArgumentParser) -> None:
    systems = parser.add_subparsers(dest="system", required=True, metavar="camera")
    calibrate_camera.add_arguments(systems.add_parser("camera", help="a camera above the arena"))


def run(arguments: argparse.Namespace) -> None:
    calibrate_camera.run(arguments)
