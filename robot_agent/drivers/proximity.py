"""What an e-puck's infra-red sensors say of distances."""

from __future__ import annotations

import numpy as np

PROXIMITY_M = (0.0, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06)
PROXIMITY_RAW = (4095.0, 2133.0, 1466.0, 601.0, 384.0, 235.0, 158.0, 120.0, 67.0)
"""Response of a sensor to a wall at these distances (epuck_ros2, INFRARED_TABLE); 67 is far away."""


def echo(distance_m: float) -> int:
    """What a sensor shows of a wall at a distance from it, 0..4095."""
    return round(float(np.interp(distance_m, PROXIMITY_M, PROXIMITY_RAW)))


def distance_m(raw: int) -> float:
    """How far a white wall with this echo is, at most 0.06 m; dark things are nearer than they seem."""
    return float(np.interp(raw, PROXIMITY_RAW[::-1], PROXIMITY_M[::-1]))
