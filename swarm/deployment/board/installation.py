"""Programs and releases, made beside those that run."""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
import sys
from typing import Any

from swarm.deployment.board.layout import COMPLETE, Board
from swarm.deployment.board.reporting import BoardError, run, step

Request = dict[str, Any]


def install(board: Board, request: Request) -> dict[str, Any]:
    """Make a program and a release of it, beside those that run; what is there already stays as it is."""
    with board.held():
        if not (board.programs / request["program"] / COMPLETE).exists():
            step("making a virtual environment")
            _install_program(board, request)
        if not (board.releases / request["release"] / COMPLETE).exists():
            _install_release(board, request)
    return board.described(request["release"])


def _install_program(board: Board, request: Request) -> None:
    place = board.programs / request["program"]
    shutil.rmtree(place, ignore_errors=True)
    site = ["--system-site-packages"] if request["system_packages"] else []
    run([sys.executable, "-m", "venv", "--without-pip", *site, str(place)])
    wheels = [board.wheels / name for name in request["wheels"]]
    for wheel in wheels:
        if hashlib.sha256(wheel.read_bytes()).hexdigest() != wheel.parent.name:
            raise BoardError(f"{wheel.name} has not arrived whole: deploy again")
    step(f"installing {len(wheels)} wheels")
    python = str(place / "bin" / "python")
    pip = [python, "-I", str(board.wheels / request["installer"] / "pip"), "--disable-pip-version-check"]
    offline = ["--no-index", "--no-deps", "--no-cache-dir", "--quiet", "--no-warn-script-location"]
    run([*pip, "install", *offline, *map(str, wheels)])
    step("trying it")
    told = run([python, "-I", "-m", "swarm.runtime.versions"])
    about = {"versions": json.loads(told), "wheels": [*request["wheels"], request["installer"]]}
    (place / COMPLETE).write_text(json.dumps(about))


def _install_release(board: Board, request: Request) -> None:
    place = board.releases / request["release"]
    shutil.rmtree(place, ignore_errors=True)
    contents = {name: base64.b64decode(content) for name, content in request["files"].items()}
    for name, content in contents.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).touch(mode=0o600)
        (place / name).write_bytes(content)
    (place / "program").symlink_to(board.programs / request["program"])
    versions = json.loads((board.programs / request["program"] / COMPLETE).read_text())["versions"]
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}
    about = {
        "services": request["starts"],
        "experiment": request["experiment"],
        "extras": request["extras"],
        "files": digests,
        "virtual_environment": request["program"],
        "build": request["build"],
        **versions,
    }
    (place / COMPLETE).write_text(json.dumps(about))
