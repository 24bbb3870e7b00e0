"""A run in a laboratory, from the server's machine: the server, and the tracker bridge if hosted here."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from swarm.access.identities import SERVER, TRACKER, Identity
from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory
from swarm.control.reaching import keys_of, settings_of
from swarm.errors import UserError
from swarm.interpreter import child_environment, module_command
from swarm.messages.topics import RUN_IDENTITY
from swarm.runtime.handshake import ANSWER_WITHIN_S, compared
from swarm.runtime.identity import RunIdentity
from swarm.runtime.zenoh_session import Session

EVERYWHERE = "0.0.0.0"
"""The server listens on every network that its machine has."""
ENDS_WITHIN_S = 30.0
"""A server waits 10 s for the robots' last words, and closes its log."""


@dataclass(frozen=True)
class LaboratoryRun:
    """The command lines of what has to be started here; the robots' agents are services on their boards."""

    server: list[str]
    bridge: list[str] | None

    @classmethod
    def of(
        cls, file: Path, experiment: Path, options: Sequence[str], common: Sequence[str], *, insecure: bool
    ) -> LaboratoryRun:
        """`options` are the server's, `common` also the bridge's. UserError if keys are missing."""
        laboratory = Laboratory.load(file)
        protocol = "tcp" if insecure else "tls"
        listen = ("--listen", f"{protocol}/{EVERYWHERE}:{laboratory.server.port}")
        own = _protection(file, SERVER, insecure)
        server = module_command("server", str(experiment), *listen, *own, *common, *options)
        if laboratory.tracker is not None:
            return cls(server, None)
        connect = ("--connect", f"{protocol}/{laboratory.server_address}")
        own = _protection(file, TRACKER, insecure)
        return cls(server, module_command("tracker_bridge", str(experiment), *connect, *own, *common))

    @contextmanager
    def started(self, messages: IO[bytes] | None) -> Iterator[subprocess.Popen[bytes]]:
        """The server's process; neither it nor the bridge outlives the block, which both end in order.

        What they say of themselves goes to `messages`, or where this process says it.
        """
        with ExitStack() as stack:
            server = stack.enter_context(_process(self.server, messages))
            stack.callback(_end, server)
            if self.bridge:
                bridge = stack.enter_context(_process(self.bridge, messages))
                stack.callback(_end, bridge)
            yield server


def is_under_way(file: Path, experiment: Path, trial: int, *, insecure: bool) -> bool:
    """Whether the laboratory's server conducts this run already. UserError if it conducts another one."""
    try:
        session = Session(settings_of(str(file), insecure=insecure))
    except UserError:
        return False
    with session:
        answers = session.ask(RUN_IDENTITY, ANSWER_WITHIN_S)
        if answers:
            compared(answers[0], RunIdentity.of(Experiment.load(experiment), trial))
    return bool(answers)


def _protection(file: Path, identity: Identity, insecure: bool) -> list[str]:
    if insecure:
        return ["--insecure"]
    folder = keys_of(file, identity)
    if folder is None:
        raise UserError(
            f"{file}: there are no keys for the {identity}: make them with `swarm lab keys {file}`, or say "
            "--insecure on a network of your own"
        )
    return ["--credentials", str(folder)]


def _process(command: list[str], messages: IO[bytes] | None) -> subprocess.Popen[bytes]:
    return subprocess.Popen(command, stderr=messages, env=child_environment())


def _end(process: subprocess.Popen[bytes]) -> None:
    """In order, or not at all."""
    process.terminate()
    try:
        process.wait(ENDS_WITHIN_S)
    except subprocess.TimeoutExpired:
        process.kill()
