"""Boards as network namespaces on one bridge, each with an OpenSSH server, and no way to anywhere else."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

BRIDGE = "swarm-boards"
OPERATOR = "10.78.0.1"
SSHD = shutil.which("sshd", path=f"{os.environ.get('PATH', '')}:/usr/sbin")

SETTINGS = """Port 22
HostKey {folder}/host_key
AuthorizedKeysFile {home}/.ssh/id_ed25519.pub
StrictModes no
UsePAM no
PasswordAuthentication no
PidFile none
Subsystem sftp internal-sftp
"""


def can_have_boards() -> bool:
    """Whether this user may make namespaces, and has an SSH server to put into them."""
    return os.geteuid() == 0 and bool(shutil.which("ip")) and SSHD is not None


@dataclass(frozen=True)
class NetworkBoard:
    """One of them."""

    namespace: str
    host: str
    folder: Path

    def inside(self, *words: str) -> list[str]:
        """A command line, run on this board."""
        return ["ip", "netns", "exec", self.namespace, *words]


@contextmanager
def board_network(directory: Path, count: int) -> Iterator[list[NetworkBoard]]:
    """So many boards, whose host keys stand in `directory`/known_hosts; HOME must be `directory`."""
    (directory / ".ssh").mkdir()
    _new_key(directory / ".ssh" / "id_ed25519")
    with ExitStack() as stack:
        _ip("link", "add", BRIDGE, "type", "bridge")
        stack.callback(_ip, "link", "del", BRIDGE)
        _ip("address", "add", f"{OPERATOR}/24", "dev", BRIDGE)
        _ip("link", "set", BRIDGE, "up")
        yield [_board(directory, number, stack) for number in range(1, count + 1)]


def _board(directory: Path, number: int, stack: ExitStack) -> NetworkBoard:
    board = NetworkBoard(f"{BRIDGE}-{number}", f"10.78.0.{number + 1}", directory / f"machine-{number}")
    _ip("netns", "add", board.namespace)
    stack.callback(_ip, "netns", "del", board.namespace)
    here, there = f"swarm-board{number}", "eth0"
    _ip("link", "add", here, "type", "veth", "peer", "name", there, "netns", board.namespace)
    stack.callback(_ip, "link", "del", here)  # a process that is left holds the namespace, and so both ends
    _ip("link", "set", here, "master", BRIDGE, "up")
    _ip("-n", board.namespace, "address", "add", f"{board.host}/24", "dev", there)
    for name in ("lo", there):
        _ip("-n", board.namespace, "link", "set", name, "up")
    _serve_ssh(directory, board, stack)
    return board


def _serve_ssh(directory: Path, board: NetworkBoard, stack: ExitStack) -> None:
    board.folder.mkdir()
    _new_key(board.folder / "host_key")
    kind, key, *_ = (board.folder / "host_key.pub").read_text().split()
    with (directory / "known_hosts").open("a") as known:
        known.write(f"{board.host} {kind} {key}\n")
    (board.folder / "sshd_config").write_text(SETTINGS.format(folder=board.folder, home=directory))
    Path("/run/sshd").mkdir(exist_ok=True)  # where sshd puts its unprivileged half
    assert SSHD
    words = [SSHD, "-D", "-e", "-f", str(board.folder / "sshd_config")]
    with (board.folder / "sshd.log").open("w") as log:
        process = stack.enter_context(subprocess.Popen(board.inside(*words), stderr=log))
    stack.callback(process.terminate)


def _new_key(file: Path) -> None:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(file)], check=True)


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)
