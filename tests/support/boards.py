"""Boards on this machine: each with an SSH server, a host key, and a folder of its own; and a small program.

The program stands in for this package's own, which takes minutes to install: it has the commands that the
units start, says that it is ready or fails, and is installed, started and watched as the real one.
"""

from __future__ import annotations

import asyncio
import ensurepip
import shutil
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from textwrap import indent
from typing import Any

import asyncssh

from tests.support.swarm_runs import ROOT

READY = """import sys, time
if any("broken" in word for word in sys.argv):
    raise SystemExit("error: this robot is broken")
from swarm.services.notification import ServiceManager
manager = ServiceManager.of_environment()
manager.ready()
while True:
    manager.going_on()
    time.sleep(0.1)
"""
COMMANDS = ("robot-agent", "tracker-bridge", "swarm-server")


class Boards:
    """SSH servers on 127.0.0.1, 127.0.0.2 and so on, on a thread of their own."""

    def __init__(self, directory: Path, host_keys: list[asyncssh.SSHKey]) -> None:
        self.directory = directory
        self.hosts = [f"127.0.0.{number}" for number, _ in enumerate(host_keys, 1)]
        self._host_keys = host_keys
        self.ports: list[int] = []
        self.commands: list[str] = []
        """Every command that was asked for."""
        self._client_key = new_key()
        self._loop = asyncio.new_event_loop()
        self._servers: list[asyncssh.SSHAcceptor] = []

    def folder(self, number: int) -> Path:
        """Where everything goes on a board."""
        return self.directory / f"board-{number}"

    @contextmanager
    def served(self, home: Path) -> Iterator[Boards]:
        """Let who has `home` for a home log in, and know the boards' host keys."""
        thread = threading.Thread(target=self._loop.run_forever)
        thread.start()
        try:
            asyncio.run_coroutine_threadsafe(self._listen(home), self._loop).result()
            yield self
        finally:
            asyncio.run_coroutine_threadsafe(self._close(), self._loop).result()
            self._loop.call_soon_threadsafe(self._loop.stop)
            thread.join()
            self._loop.close()

    async def _listen(self, home: Path) -> None:
        (home / ".ssh").mkdir(parents=True)
        self._client_key.write_private_key(home / ".ssh" / "id_ed25519")
        (home / ".ssh" / "id_ed25519").chmod(0o600)
        allowed = asyncssh.import_authorized_keys(self._client_key.export_public_key().decode())
        for host, key in zip(self.hosts, self._host_keys, strict=True):
            server = await asyncssh.listen(
                host,
                0,
                server_host_keys=[key],
                authorized_client_keys=allowed,
                process_factory=self._run,
                sftp_factory=True,
                encoding=None,
            )
            self._servers.append(server)
            self.ports.append(server.get_port())
            line = f"[{host}]:{server.get_port()} {key.export_public_key().decode()}"
            with (home / ".ssh" / "known_hosts").open("a") as known:
                known.write(line)

    async def _close(self) -> None:
        for server in self._servers:
            server.close()
            await server.wait_closed()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    async def _run(self, process: asyncssh.SSHServerProcess[bytes]) -> None:
        """As sshd does: the login shell gets the command."""
        assert process.command
        self.commands.append(process.command)
        pipe = asyncio.subprocess.PIPE
        shell = await asyncio.create_subprocess_shell(process.command, stdin=pipe, stdout=pipe, stderr=pipe)
        assert shell.stdin
        listening = asyncio.create_task(_passed_on(process.stdin, shell.stdin))
        listening.add_done_callback(lambda done: shell.stdin.close())  # type: ignore[union-attr] # noqa: ARG005
        try:
            await _passed_on(shell.stdout, process.stdout)
            await _passed_on(shell.stderr, process.stderr)
            process.exit(await shell.wait())
        finally:
            listening.cancel()
            await shell.communicate()


async def _passed_on(source: Any, sink: Any) -> None:
    """Bytes as they come, until their end; whoever was to get them may be gone."""
    with suppress(ConnectionError):
        while piece := await source.read(65_536):
            sink.write(piece)


def new_key() -> asyncssh.SSHKey:
    """A key of a host, or of somebody."""
    return asyncssh.generate_private_key("ssh-ed25519")


def small_wheelhouse(place: Path) -> Path:
    """A folder with the pip that Python ships, so that no test needs a network."""
    (bundled,) = (Path(ensurepip.__file__).parent / "_bundled").glob("pip-*.whl")
    (place / "installer").mkdir(parents=True)
    shutil.copy(bundled, place / "installer")
    return place


def small_program(wheelhouse: Path, version: str) -> None:
    """The wheel of a program whose every command gets ready, but for a robot at an address called broken."""
    about = f"swarm_runtime-{version}.dist-info"
    entries = "".join(f"{name} = small_program:main\n" for name in COMMANDS)
    told = f'print(\'{{"program": "{version}", "messages": "0"}}\')\n'
    contents = {
        "small_program.py": f"def main():\n{indent(READY, '    ')}",
        "swarm/runtime/versions.py": told,
        f"{about}/METADATA": f"Metadata-Version: 2.1\nName: swarm-runtime\nVersion: {version}\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{about}/entry_points.txt": f"[console_scripts]\n{entries}",
    }
    kept = [ROOT / "swarm" / "__init__.py", ROOT / "swarm" / "errors.py"]
    for file in [*kept, *(ROOT / "swarm" / "services").glob("*.py")]:
        contents[str(file.relative_to(ROOT))] = file.read_text()
    contents[f"{about}/RECORD"] = "".join(f"{name},,\n" for name in [*contents, f"{about}/RECORD"])
    wheel = wheelhouse / f"swarm_runtime-{version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, content in contents.items():
            archive.writestr(zipfile.ZipInfo(name), content)
