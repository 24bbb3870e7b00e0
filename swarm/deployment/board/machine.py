"""What a machine is, and what is on it."""

from __future__ import annotations

import base64
import platform
import shutil
import struct
import subprocess
import sys
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from typing import Any

from swarm.deployment.board.layout import COMPLETE, Board


def look(board: Board, request: dict[str, Any]) -> dict[str, Any]:
    """What the machine is, and what is on it."""
    current = board.linked("current")
    about = board.described(current)
    return {
        "root": str(board.root),
        "machine": platform.machine(),
        "bits": 8 * struct.calcsize("P"),
        "libc": platform.libc_ver()[1],
        "python": platform.python_version(),
        "packages": {name: _version_of(name, module) for name, module in request["packages"].items()},
        "wheels": sorted(str(path.relative_to(board.wheels)) for path in board.wheels.glob("*/*.whl")),
        "programs": sorted(path.parent.name for path in board.programs.glob(f"*/{COMPLETE}")),
        "releases": sorted(path.parent.name for path in board.releases.glob(f"*/{COMPLETE}")),
        "current": current,
        "before": board.linked("before"),
        "about": about,
        "experiment": {name: _text(board.releases / current / name) for name in about.get("experiment", [])},
        "services": {name: board.services.state(name) for name in about["services"]},
        "free_bytes": shutil.disk_usage(
            next(p for p in (board.root, *board.root.parents) if p.exists())
        ).free,
    }


def _text(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode()


def _version_of(distribution: str, module: str) -> str:
    """Of a package that the system's Python has; Debian gives some of them other names, or none."""
    with suppress(metadata.PackageNotFoundError):
        return metadata.version(distribution)
    asked = f"import {module}; print({module}.__version__)"
    found = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=False)
    return found.stdout.strip()
