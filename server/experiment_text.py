"""The experiment file that a run keeps: with what `--set` changed, and else as it was, comments and all.

The run's processes are given this file, its logs hold it, and replays read it: there is one experiment.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import tomlkit

from swarm.config.changes import changes_of


def experiment_bytes(file: Path, changes: Sequence[str]) -> bytes:
    """The file with its changes; byte for byte the same if there are none."""
    text = file.read_bytes()
    if not changes:
        return text
    document = tomlkit.parse(text)
    for change in changes_of(changes):
        change.apply(document)
    return tomlkit.dumps(document).encode()
