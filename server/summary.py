"""The end of a run as a person reads it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def print_summary(summary: Mapping[str, Any]) -> None:
    """Where the run is, how long it took, and what to do next."""
    hours = summary["sim_s"] / 3600
    print(f"run        {summary['run']}")
    print(f"moves      {summary['moves']}, {hours:.1f} h of the robots' time in {summary['wall_s']:.0f} s")
    print(f"speed      {summary['real_time_factor']:.0f} times real time")
    print(f"digest     {summary['digest'][:16]}")
    print(f"next       swarm analyze {summary['run']}")
