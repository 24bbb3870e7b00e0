"""The outermost frame of every command."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from swarm.errors import RunFailedError, UserError


def guarded(call: Callable[[], object]) -> int:
    """Run a command; turn its errors into one line on stderr and an exit code, never a traceback."""
    try:
        call()
    except UserError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except RunFailedError as error:
        print(f"failed: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    return 0
