"""What every process of the swarm does alike: command line, signals, joining the others, leaving.

The command line is argparse with one-line errors, so that a board needs no extra.
"""

from __future__ import annotations

import argparse
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from swarm.clock import scaled_clock, unix_clock
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.runtime.handshake import agreed_run
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.lockstep import EPOCH, LockstepNode, patient
from swarm.runtime.node import LiveNode, Node
from swarm.runtime.zenoh_session import Session, SessionSettings
from swarm.version import version_text

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"


class OneLineParser(argparse.ArgumentParser):
    """A parser whose errors are one line (exit code 2), with `--version`."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.add_argument("--version", action=_ShowVersion, nargs=0, help="print the version and leave")

    def error(self, message: str) -> NoReturn:
        raise UserError(f"{message} (see `{self.prog} --help`)")


class _ShowVersion(argparse.Action):
    """Looks the version up only when it is asked for: that takes a board longer than a start should."""

    def __call__(self, *_: Any) -> NoReturn:
        print(version_text())
        sys.exit(0)


def add_common_arguments(parser: argparse.ArgumentParser) -> None:
    """The experiment, the server, and how time passes."""
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="what is run")
    parser.add_argument(
        "--connect", default=DEFAULT_ENDPOINT, metavar="tcp/HOST:PORT", help="the server (%(default)s)"
    )
    parser.add_argument(
        "--zenoh-config", type=Path, metavar="FILE", help="Zenoh settings for TLS, users and access control"
    )
    simulated = parser.add_argument_group("simulation", "the server gives these to the processes it starts")
    simulated.add_argument("--process", default="", help="the name of this process in a lockstep run")
    simulated.add_argument("--lockstep", action="store_true", help="step when the server says so")
    simulated.add_argument("--started-ns", type=int, default=0, help="monotonic time at which the run began")
    simulated.add_argument("--speed", type=float, default=1.0, help="how many times as fast as life")
    simulated.add_argument("--trial", type=int, default=0, help="the number of the trial, from 0")
    simulated.add_argument("--seed", type=int, default=None, help="in place of the experiment's")
    simulated.add_argument("--moves", type=int, default=None, help="in place of the experiment's")


def load_experiment(arguments: argparse.Namespace) -> Experiment:
    """The experiment that the command line names, with what else it says."""
    return Experiment.load(arguments.experiment).changed(seed=arguments.seed, moves=arguments.moves)


@contextmanager
def joined(
    arguments: argparse.Namespace, kind: str, names: list[str], period_s: float, identity: RunIdentity
) -> Iterator[Node]:
    """The node of a process that is present under its names for as long as the block runs.

    UserError if the run on the server is not the one that `identity` tells of.
    """
    epoch = EPOCH if arguments.lockstep else time.time_ns()
    settings = SessionSettings(arguments.connect, config=arguments.zenoh_config)
    if arguments.lockstep:
        settings = patient(settings)
    with Session(settings) as session:
        for name in names:
            claim(session, Presence(kind, name, socket.gethostname(), epoch, str(identity.fingerprint)))
        if arguments.lockstep:
            yield LockstepNode(session, arguments.process)
        else:
            run_id = agreed_run(session, identity, unix_clock())
            simulated = arguments.started_ns
            clock = scaled_clock(simulated, arguments.speed) if simulated else unix_clock()
            yield LiveNode(session, clock, period_s, epoch, run_id)


def leave_on_signals() -> None:
    """SIGTERM and SIGHUP end the process as SIGINT does: through every `finally`, with 128 + the number."""

    def leave(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        sys.exit(128 + number)

    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        signal.signal(number, leave)
