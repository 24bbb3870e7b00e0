"""What every process of the swarm does alike: command line, signals, joining the others, leaving.

The command line is argparse with one-line errors, so that a board needs no extra.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from swarm.clock import scaled_clock, unix_clock
from swarm.config import arguments as values
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.messages.topics import EARLIER
from swarm.runtime.endpoint import DEFAULT_ENDPOINT
from swarm.runtime.handshake import agreed_run
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import NO_IDENTITY, Presence, claim
from swarm.runtime.lockstep import EPOCH, LockstepNode, patient
from swarm.runtime.node import LiveNode, Node
from swarm.runtime.spool import Spool
from swarm.runtime.zenoh_session import Session, SessionSettings
from swarm.services.notification import ServiceManager
from swarm.version import version_text

PR_SET_PDEATHSIG = 1
"""From linux/prctl.h: the signal that a process gets when its parent ends."""
LEAVE_WITHIN_S = 5.0
"""A process leaves after its step, which takes far less; one that has not by then hangs."""


class OneLineParser(argparse.ArgumentParser):
    """A parser whose errors are one line (exit code 2), with `--version`."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.add_argument("--version", action=_ShowVersion, nargs=0, help="print the version and leave")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse does, which would take `--moves=--` for an option without a value, and its default."""
        words = sys.argv[1:] if args is None else list(args)
        for word in words:
            if word.startswith("--") and word.endswith("=--"):
                self.error(f"{word} has no value")
        return super().parse_known_args(words, namespace)

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
    add_set_option(parser)
    parser.add_argument(
        "--connect", default=DEFAULT_ENDPOINT, metavar="tls/HOST:PORT", help="the server (%(default)s)"
    )
    parser.set_defaults(state=None)
    add_protection_arguments(parser)
    simulated = parser.add_argument_group("simulation", "the server gives these to the processes it starts")
    simulated.add_argument("--process", default="", help="the name of this process in a lockstep run")
    simulated.add_argument(
        "--supervised", action="store_true", help="leave when standard input ends, and say nothing of it"
    )
    simulated.add_argument("--lockstep", action="store_true", help="step when the server says so")
    simulated.add_argument("--started-ns", type=int, default=0, help="monotonic time at which the run began")
    simulated.add_argument("--speed", type=values.pace, default=1.0, help="how many times as fast as life")
    simulated.add_argument("--trial", type=values.trial, default=0, help="the number of the trial, from 0")
    simulated.add_argument("--seed", type=values.seed, default=None, help="in place of the experiment's")
    simulated.add_argument("--moves", type=values.moves, default=None, help="in place of the experiment's")


def add_protection_arguments(parser: argparse.ArgumentParser) -> None:
    """How a process shows who it is, and whether it need not."""
    parser.add_argument(
        "--credentials", type=Path, metavar="DIR", help="its folder of the keys that `swarm lab keys` makes"
    )
    parser.add_argument(
        "--insecure", action="store_true", help="without certificates although other machines can connect"
    )
    parser.add_argument("--zenoh-config", type=Path, metavar="FILE", help="more settings of Zenoh's (JSON5)")


def session_settings(arguments: argparse.Namespace, endpoint: str, **more: Any) -> SessionSettings:
    """Settings of the session that a command line asks for."""
    return SessionSettings(
        endpoint,
        config=arguments.zenoh_config,
        credentials=arguments.credentials,
        insecure=arguments.insecure,
        **more,
    )


def load_experiment(arguments: argparse.Namespace) -> Experiment:
    """The experiment that the command line names, with what else it says."""
    experiment = Experiment.load(arguments.experiment, arguments.set)
    return experiment.changed(seed=arguments.seed, moves=arguments.moves)


@contextmanager
def joined(
    arguments: argparse.Namespace, kind: str, names: list[str], period_s: float, identity: RunIdentity | None
) -> Iterator[Node]:
    """The node of a process that is present under its names for as long as the block runs.

    UserError if the run on the server is not the one that `identity` tells of; None is for a tool that takes
    part in no run, and needs none.
    """
    epoch = EPOCH if arguments.lockstep else time.time_ns()
    settings = session_settings(arguments, arguments.connect)
    if arguments.lockstep:
        settings = patient(settings)
    manager = ServiceManager.of_environment()
    manager.ready()
    say = _say_nothing if arguments.supervised else partial(_say_and_tell, manager)
    shown = str(identity.fingerprint) if identity else NO_IDENTITY
    waiting = Waiting(manager, partial(say, f"waiting for the server at {settings.endpoint}"))
    with Session(settings, waiting.moment) as session:
        for name in names:
            claim(session, Presence(kind, name, socket.gethostname(), epoch, shown))
        if arguments.lockstep:
            yield LockstepNode(session, arguments.process)
        else:
            going_on = manager.going_on
            run_id = agreed_run(session, identity, unix_clock(), going_on) if identity else ""
            say(f"connected to the server at {settings.endpoint}")
            simulated = arguments.started_ns
            clock = scaled_clock(simulated, arguments.speed) if simulated else unix_clock()
            presence = Presence(kind, "", socket.gethostname(), epoch, shown)
            spool = _spool(arguments, session, presence, names, run_id)
            node = LiveNode(session, clock, period_s, epoch, run_id, say, going_on, spool)
            try:
                yield node
            finally:
                node.give_account(names[0])
                if spool:
                    spool.close()


def _spool(
    arguments: argparse.Namespace, session: Session, presence: Presence, names: list[str], run_id: str
) -> Spool | None:
    """What this process keeps on its disk if it has a place there; it speaks for its earlier starts, too."""
    if not (arguments.state and run_id and presence.kind in EARLIER):
        return None
    spool = Spool(arguments.state, names[0], run_id, _say)
    for name in names:
        for epoch in spool.epochs:
            earlier = replace(presence, kind=EARLIER[presence.kind], name=name, epoch=epoch)
            session.declare_alive(earlier.key)
    return spool


def leave_with_parent() -> None:
    """Leave as soon as standard input ends: whoever started this process holds it open, alive or not at all.

    A pipe ends with its writer on every system. A process that was stopped does not see it: on Linux the end
    of its parent lets it go on.
    """
    with suppress(AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGCONT)
    threading.Thread(target=_await_parents_end, daemon=True).start()


def _await_parents_end() -> None:
    while os.read(sys.stdin.fileno(), 1024):
        pass
    _say("failed: the server is gone")
    os.kill(os.getpid(), signal.SIGTERM)
    threading.Event().wait(LEAVE_WITHIN_S)
    os._exit(1)


class Waiting:
    """For a server that is not there yet: said once, while the service's manager hears that it goes on."""

    def __init__(self, manager: ServiceManager, say: Callable[[], None]) -> None:
        self._manager = manager
        self._say = say
        self._said = False

    def moment(self) -> None:
        """One more moment has passed."""
        self._manager.going_on()
        if not self._said:
            self._said = True
            self._say()


def _say_and_tell(manager: ServiceManager, text: str) -> None:
    _say(text)
    manager.about(text)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _say_nothing(text: str) -> None:
    """The server watches a process that it started."""
