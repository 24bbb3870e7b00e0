"""`tracker-bridge decode`."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from swarm.errors import UserError
from tracker_bridge.protocols import natnet, vicon
from tracker_bridge.protocols.cursor import DatagramError
from tracker_bridge.protocols.natnet_decoding import decoded_packet


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("system", choices=["natnet", "vicon"], help="whose packet it is")
    parser.add_argument("file", type=Path, metavar="FILE", help="one UDP payload, as captured")
    parser.add_argument("--version", default="3.0", help="NatNet's version, 2.5 to 4.1 (%(default)s)")
    parser.add_argument("--json", action="store_true", help="print it as one line of JSON")


def run(arguments: argparse.Namespace) -> None:
    """Print the packet; UserError if it is none of that system."""
    try:
        data = arguments.file.read_bytes()
        if arguments.system == "natnet":
            packet = decoded_packet(data, natnet.version_of(arguments.version))
        else:
            packet = asdict(vicon.parse(data))
    except OSError as error:
        raise UserError(f"{arguments.file}: {error.strerror}") from error
    except DatagramError as error:
        raise UserError(f"{arguments.file}: no {arguments.system} packet: {error}") from error
    except ValueError as error:
        raise UserError(f"--version: {error}") from error
    print(json.dumps(packet, indent=None if arguments.json else 2))
