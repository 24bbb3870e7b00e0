"""The way to a machine: SSH, with its host key checked, and this package's own program at the other end."""

from __future__ import annotations

import io
import json
import time
import zipfile
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from functools import cache
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path, PurePosixPath
from typing import Any

import asyncssh

from swarm.config.laboratory import Machine

CONNECT_WITHIN_S = 20.0
"""Longer than a board on a bad radio link takes for its keys."""
ALIVE_EVERY_S = 15.0
"""A machine that is silent for three times this is gone."""
TIMES_ASKED = 8
"""For a machine's time: the quickest answer counts, since the others have waited on their way."""
UNKNOWN_HOST_KEY = (
    "its host key is not among the known ones: read it on the machine (ssh-keygen -lf "
    "/etc/ssh/ssh_host_ed25519_key.pub), compare, and add it with ssh-keyscan"
)


class MachineError(Exception):
    """What went wrong on one machine, or on the way there; the others go on."""


class Link:
    """A connection to a machine. `tell` is called with every step that the machine takes."""

    def __init__(
        self,
        connection: asyncssh.SSHClientConnection,
        machine: Machine,
        services: str,
        tell: Callable[[str], None],
    ) -> None:
        self._connection = connection
        self._machine = machine
        self._services = services
        self._tell = tell
        self._program = ""

    @property
    def host_key(self) -> str:
        """The fingerprint of the machine's key: who copies its card copies this too."""
        key = self._connection.get_server_host_key()
        return key.get_fingerprint() if key else ""

    async def prepare(self) -> None:
        """Send the program that answers, if it is not there; before everything else."""
        content = board_program()
        self._program = f"{self._machine.directory}/board-{sha256(content).hexdigest()[:12]}.pyz"
        async with self._connection.start_sftp_client() as sftp:
            if not await sftp.exists(self._program):
                await sftp.makedirs(self._machine.directory, exist_ok=True)
                await _put(sftp, io.BytesIO(content), self._program)

    async def ask(self, verb: str, **request: Any) -> dict[str, Any]:
        """Have the machine do something (see swarm.deployment.board); MachineError if it cannot."""
        async with self._asked(verb, request) as process:
            process.stdin.write_eof()
            async for line in process.stdout:
                if (result := self._answer(line)) is not None:
                    return result
            said = (await process.stderr.read()).strip().splitlines()
        raise MachineError(said[-1] if said else f"{self._machine.python} ended without an answer")

    async def clock_ahead_ns(self) -> tuple[int, int]:
        """How far the machine's clock is ahead of this one, and by how much that may be wrong, either way."""
        measured = []
        async with self._asked("tell_time", {}) as process:
            for _ in range(TIMES_ASKED):
                asked_ns = time.time_ns()
                process.stdin.write("\n")
                line = await process.stdout.readline()
                half_ns = (time.time_ns() - asked_ns) // 2
                measured.append((half_ns, json.loads(line)["t_ns"] - asked_ns - half_ns))
        error_ns, ahead_ns = min(measured)
        return ahead_ns, error_ns

    @asynccontextmanager
    async def _asked(
        self, verb: str, request: dict[str, Any]
    ) -> AsyncIterator[asyncssh.SSHClientProcess[str]]:
        request = request | {"verb": verb, "directory": self._machine.directory, "services": self._services}
        command = f"{self._machine.python} {self._program}"
        async with self._connection.create_process(command) as process:
            process.stdin.write(f"{json.dumps(request)}\n")
            yield process

    def _answer(self, line: str) -> dict[str, Any] | None:
        """The result, if a line holds it. What else a login prints is passed over."""
        try:
            ((kind, content),) = json.loads(line).items()
        except (AttributeError, ValueError):
            return None
        if kind == "error":
            raise MachineError(str(content))
        if kind == "step":
            self._tell(str(content))
        return content if kind == "result" and isinstance(content, dict) else None

    async def copy(self, file: Path, place: str) -> None:
        """Copy a file to a place below the machine's directory; it has its name once it is whole."""
        target = f"{self._machine.directory}/{place}"
        async with self._connection.start_sftp_client() as sftp:
            await sftp.makedirs(str(PurePosixPath(target).parent), exist_ok=True)
            with file.open("rb") as source:
                await _put(sftp, source, target)


@asynccontextmanager
async def linked(
    machine: Machine, services: str, known_hosts: Path | None, tell: Callable[[str], None]
) -> AsyncIterator[Link]:
    """A link to a machine; MachineError if it cannot be reached, or is not the one that is known."""
    trusted: dict[str, Any] = {"known_hosts": str(known_hosts)} if known_hosts else {}
    with in_words():
        connection = await asyncssh.connect(
            machine.host,
            machine.ssh_port,
            username=machine.user,
            connect_timeout=CONNECT_WITHIN_S,
            keepalive_interval=ALIVE_EVERY_S,
            **trusted,
        )
    async with connection:
        yield Link(connection, machine, services, tell)


@contextmanager
def in_words() -> Iterator[None]:
    """Whatever can go wrong on the way to a machine becomes a MachineError."""
    try:
        yield
    except asyncssh.HostKeyNotVerifiable as error:
        raise MachineError(UNKNOWN_HOST_KEY) from error
    except asyncssh.PermissionDenied as error:
        raise MachineError("it does not let this user in: copy a key there with ssh-copy-id") from error
    except asyncssh.Error as error:
        raise MachineError(f"the connection failed ({error.reason})") from error
    except (OSError, TimeoutError) as error:
        raise MachineError(
            f"it cannot be reached ({getattr(error, 'strerror', None) or 'no answer'})"
        ) from error


async def _put(sftp: asyncssh.SFTPClient, source: Any, target: str) -> None:
    async with sftp.open(f"{target}.part", "wb") as file:
        while piece := source.read(PIECE_BYTES):
            await file.write(piece)
    await sftp.posix_rename(f"{target}.part", target)


PIECE_BYTES = 1 << 20
"""asyncssh sends it as many requests at a time."""


@cache
def board_program() -> bytes:
    """The package that is sent to a machine, as a zip that Python runs."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for package in ("swarm", "swarm.deployment", "swarm.deployment.board"):
            for source in _sources(package):
                _add(archive, f"{package.replace('.', '/')}/{source.name}", source.read_bytes())
        _add(archive, "__main__.py", b"from swarm.deployment.board.verbs import main\n\nmain()\n")
    return content.getvalue()


def _sources(package: str) -> list[Traversable]:
    """Of the packages above only what makes them packages."""
    wanted = files(package).iterdir()
    own = package.endswith(".board")
    return sorted(
        (file for file in wanted if file.name == "__init__.py" or (own and file.name.endswith(".py"))),
        key=lambda file: file.name,
    )


def _add(archive: zipfile.ZipFile, name: str, content: bytes) -> None:
    """Without a time: the same program has the same bytes."""
    archive.writestr(zipfile.ZipInfo(name), content)
