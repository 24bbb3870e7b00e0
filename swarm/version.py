"""Which version of the package this is."""

from __future__ import annotations

DISTRIBUTION = "swarm-runtime"


def version_text() -> str:
    """What every command's `--version` prints."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return f"{DISTRIBUTION} {version(DISTRIBUTION)}"
    except PackageNotFoundError:
        return f"{DISTRIBUTION}, not installed"
