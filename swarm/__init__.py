"""The shared library of the swarm runtime: messages, clocks, learning, analysis.

For notebooks: `swarm.open_run("runs/demo")`. Importing this package loads nothing else of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from os import PathLike

    from swarm.analysis.recorded_run import RecordedRun

__all__ = ["open_run"]


def open_run(*runs: str | PathLike[str]) -> RecordedRun:
    """What was recorded in run directories or .mcap files; several are pooled.

    UserError if they are no runs or cannot be put together, or if the extra `lab` is not installed.
    """
    from swarm.extras import require_extra

    require_extra("lab", "matplotlib", "mcap", "polars", "scipy")
    from swarm.analysis.recorded_run import RecordedRun

    return RecordedRun(*runs)
