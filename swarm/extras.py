"""The extras of the installation, and what is said when one is missing."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager

from swarm.errors import UserError

EXTRA_OF = {"cv2": "vision"}
"""What a board may lack: it needs pictures only where a robot watches."""


def require_extra(extra: str, *modules: str) -> None:
    """UserError with the extra to install if one of its modules is missing."""
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    if missing:
        raise UserError(
            f"this command needs {', '.join(missing)}: install it with pip install 'swarm-runtime[{extra}]'"
        )


@contextmanager
def naming_extras() -> Iterator[None]:
    """What the block misses while it loads its modules becomes a UserError with the extra to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name not in EXTRA_OF:
            raise
        require_extra(EXTRA_OF[error.name], error.name)
        raise
