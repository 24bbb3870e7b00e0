"""What every verb prints in the end, and the extras it may need."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Mapping
from typing import Any

from swarm.errors import UserError


def print_json(result: Mapping[str, Any]) -> None:
    """The verb's result as one JSON object, the last line of stdout."""
    print(json.dumps(result, allow_nan=False), flush=True)


def require_extra(extra: str, *modules: str) -> None:
    """Stop with the name of the extra to install if one of its modules is missing."""
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    if missing:
        raise UserError(
            f"this command needs {', '.join(missing)}: install it with pip install 'swarm-runtime[{extra}]'"
        )
