"""What every verb prints in the end."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def print_json(result: Mapping[str, Any]) -> None:
    """The verb's result as one JSON object, the last line of stdout."""
    print(json.dumps(result, allow_nan=False), flush=True)
