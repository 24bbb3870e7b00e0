"""What a machine runs: the program's version and the digest of its messages, as JSON.

python -m swarm.runtime.versions
"""

from __future__ import annotations

import json
from importlib.metadata import PackageNotFoundError, version

from swarm.runtime.identity import schema_digest
from swarm.version import DISTRIBUTION


def versions() -> dict[str, str]:
    """`program` and `messages`: everybody in a run has to have the same."""
    try:
        program = version(DISTRIBUTION)
    except PackageNotFoundError:
        program = ""
    return {"program": program, "messages": schema_digest()}


if __name__ == "__main__":
    print(json.dumps(versions()))
