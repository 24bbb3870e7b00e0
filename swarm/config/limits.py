"""Limits that the experiment file and the command line share."""

from __future__ import annotations

MOST_MOVES = 10_000_000
"""More than 600 times the paper's: 9 months of robots that never rest."""
LARGEST_SEED = 2**63 - 1
"""What TOML can write."""
MOST_PROCESSES = 1000
"""Far more than one machine keeps pace with."""
LARGEST_TRIAL = 2**32 - 1
"""What the run's state can say (uint32)."""
SLOWEST, FASTEST = 0.01, 1000.0
"""Times as fast as life: beyond it one machine keeps pace with no robot (`make demo` does 200)."""
MOST_JOBS = 10_000
"""Processes at a time: more than a cluster's scheduler hands out well."""
MOST_TRIALS = 1_000_000
"""Of the abstract engine: some days of a machine's time."""
MOST_FRAMES = 500
"""Of a visit, whose observation is one message: with 91 bytes each, and 60 a move, it stays below 64 kB."""
BEYOND_CORNER_M = 0.05
"""An observer's place in x and in y: its body, of 0.035 m radius, is wholly outside the compartment."""
