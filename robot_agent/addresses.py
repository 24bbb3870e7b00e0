"""Where real robots are, when a command line says it in place of the experiment's file."""

from __future__ import annotations

import argparse

from swarm.errors import UserError


def add_address_argument(parser: argparse.ArgumentParser) -> None:
    """`--address`, once for each robot."""
    parser.add_argument(
        "--address",
        action="append",
        default=[],
        metavar="ID=ADDRESS",
        help="where a robot is, in place of the experiment's address",
    )


def addresses(texts: list[str]) -> dict[str, str]:
    """Addresses by robot; UserError for a text that is none."""
    found = {}
    for text in texts:
        robot, equals, address = text.partition("=")
        if not (robot and equals and address):
            raise UserError(f"--address {text!r}: say ROBOT=ADDRESS, as in r1=/dev/ttyACM0")
        found[robot] = address
    return found
