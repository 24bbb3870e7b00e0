"""An agent that drives a real body straight on for ever: what the watchdog's tests kill and stop.

`python -m tests.support.driving_agent LINK ADDRESS [TICK]`: at this tick it stops itself between looking and
commanding, and when it is continued it sends what it had decided before, and ends.
"""

from __future__ import annotations

import os
import signal
import sys

from robot_agent.drivers.epuck_driver import KINDS, opened_body
from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from swarm.clock import unix_clock

FULL_SPEED = WheelSpeeds(1000.0, 1000.0)


def main(link: str, address: str, stops_at: int) -> None:
    """Look and drive ten times a second."""
    body = opened_body(KINDS[link], address, EpuckGeometry(), 1.0, print)
    body.wait_for_robot()
    for tick, t_ns in enumerate(unix_clock().ticks(0.1)):
        body.wheel_steps(t_ns)
        if tick == stops_at:
            os.kill(os.getpid(), signal.SIGSTOP)
        body.drive(FULL_SPEED, t_ns)
        if tick == stops_at:
            os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else -1)
