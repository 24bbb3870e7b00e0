"""The extras of the installation, and what is said when one is missing."""

from __future__ import annotations

import importlib.util

from swarm.errors import UserError


def require_extra(extra: str, *modules: str) -> None:
    """UserError with the extra to install if one of its modules is missing."""
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    if missing:
        raise UserError(
            f"this command needs {', '.join(missing)}: install it with pip install 'swarm-runtime[{extra}]'"
        )
