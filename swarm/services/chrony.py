"""How far this machine's clock is off, by chrony, which sets it by the laboratory's server."""

from __future__ import annotations

import subprocess

ANSWER_WITHIN_S = 2.0
"""chronyd answers from the same machine, in milliseconds unless it is not there."""
REFERENCE, OFFSET_S, ROOT_DELAY_S, ROOT_DISPERSION_S = 1, 4, 10, 11
"""Fields of `chronyc -c tracking` (chronyc(1)). An offset above 0 says that the clock is slow."""


def told_offset() -> str:
    """For people and for the log, such as "0.031 ms fast of 192.168.1.10, to 0.4 ms"; empty without chrony.

    The error is chrony's own bound: half of the root delay, and the root dispersion.
    """
    try:
        done = subprocess.run(
            ["chronyc", "-n", "-c", "tracking"],
            capture_output=True,
            text=True,
            check=True,
            timeout=ANSWER_WITHIN_S,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return in_words(done.stdout)


def in_words(tracking: str) -> str:
    """What a line of `chronyc -c tracking` says; empty if chrony follows nobody yet."""
    fields = tracking.strip().split(",")
    if len(fields) <= ROOT_DISPERSION_S or not fields[REFERENCE]:
        return ""
    offset_ms = 1000 * float(fields[OFFSET_S])
    error_ms = 1000 * (float(fields[ROOT_DELAY_S]) / 2 + float(fields[ROOT_DISPERSION_S]))
    way = "slow" if offset_ms > 0 else "fast"
    return f"{abs(offset_ms):.3f} ms {way} of {fields[REFERENCE]}, to {error_ms:.1f} ms"
