"""What a simulated tracking system reports of a true pose: one model for runs and for single processes."""

from __future__ import annotations

from collections.abc import Sequence

from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose, wrap_angle_rad


def measured(truth: Pose, settings: TrackerSettings, noise: Sequence[float], loss: float) -> Pose | None:
    """The pose with its noise, or None if it is missing.

    `noise` holds standard normal numbers for x, y and the heading, `loss` is uniform in [0, 1).
    """
    if loss < settings.loss:
        return None
    x_noise, y_noise, theta_noise = noise
    return Pose(
        truth.x_m + settings.noise_m * x_noise,
        truth.y_m + settings.noise_m * y_noise,
        wrap_angle_rad(truth.theta_rad + settings.noise_rad * theta_noise),
    )
