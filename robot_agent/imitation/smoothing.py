"""The Rauch-Tung-Striebel smoother for a body of nearly constant velocity.

Forward a Kalman filter, backward the smoother's recursion (Rauch, Tung and Striebel, 1965), with
the state (x, y, x', y') and white noise in the acceleration.
"""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.trajectory import CHI2_GATE, Floats, SmoothedTrajectory, Trajectory

ACCELERATION_NOISE_M2_S3 = 0.025
"""q: 250 cm^2/s^3 follows a robot that starts and stops within a quarter of a second."""
FIRST_SPEED_SD_M_S = 0.10
"""The speed at which robots drive: nothing is known of the first position's velocity but that."""


def smooth(trajectory: Trajectory) -> SmoothedTrajectory:
    """Of at least one position."""
    steps = [(_transition(dt_s), _process_noise(dt_s)) for dt_s in np.diff(trajectory.t_s)]
    states, covariances, predictions = _filter(trajectory, steps)
    _smooth_backwards(states, covariances, predictions, steps)
    covariance_m2 = covariances[:, :2, :2]
    return SmoothedTrajectory(trajectory.t_ns, states[:, :2], covariance_m2, trajectory, states[:, 2:])


Step = tuple[Floats, Floats]
"""The transition and the process noise from one detection to the next."""


def _filter(trajectory: Trajectory, steps: list[Step]) -> tuple[Floats, Floats, list[Step]]:
    """Filtered states [N, 4] and covariances [N, 4, 4], and what was predicted after each step."""
    states, covariances = np.zeros((len(trajectory), 4)), np.zeros((len(trajectory), 4, 4))
    states[0, :2] = trajectory.xy_m[0]
    covariances[0] = np.diag([0.0, 0.0, FIRST_SPEED_SD_M_S**2, FIRST_SPEED_SD_M_S**2])
    covariances[0, :2, :2] = trajectory.covariance_m2[0]
    predictions = []
    for i, (transition, noise) in enumerate(steps):
        state = transition @ states[i]
        covariance = transition @ covariances[i] @ transition.T + noise
        predictions.append((state, covariance))
        seen_m, seen_m2 = trajectory.xy_m[i + 1], trajectory.covariance_m2[i + 1]
        states[i + 1], covariances[i + 1] = _update(state, covariance, seen_m, seen_m2)
    return states, covariances, predictions


def _update(state: Floats, covariance: Floats, seen_m: Floats, seen_m2: Floats) -> Step:
    """The Kalman update, or the prediction itself if the detection is outside the gate."""
    innovation = seen_m - state[:2]
    weight = _inverse(covariance[:2, :2] + seen_m2)
    if innovation @ weight @ innovation > CHI2_GATE:
        return state, covariance
    gain = covariance[:, :2] @ weight
    return state + gain @ innovation, covariance - gain @ covariance[:2]


def _smooth_backwards(
    states: Floats, covariances: Floats, predictions: list[Step], steps: list[Step]
) -> None:
    """Replace the filtered by the smoothed estimates, from the last but one to the first."""
    for i in range(len(steps) - 1, -1, -1):
        predicted, predicted_covariance = predictions[i]
        gain = np.linalg.solve(predicted_covariance, steps[i][0] @ covariances[i]).T
        states[i] += gain @ (states[i + 1] - predicted)
        covariances[i] += gain @ (covariances[i + 1] - predicted_covariance) @ gain.T


def _inverse(matrix: Floats) -> Floats:
    """Of a 2 x 2 matrix; much faster than the general one."""
    (a, b), (c, d) = matrix.tolist()
    inverse: Floats = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
    return inverse


def _transition(dt_s: float) -> Floats:
    transition = np.eye(4)
    transition[0, 2] = transition[1, 3] = dt_s
    return transition


def _process_noise(dt_s: float) -> Floats:
    """Integral of white acceleration noise over a step."""
    noise = np.zeros((4, 4))
    for axis in (0, 1):
        noise[axis, axis] = dt_s**3 / 3
        noise[axis, axis + 2] = noise[axis + 2, axis] = dt_s**2 / 2
        noise[axis + 2, axis + 2] = dt_s
    return ACCELERATION_NOISE_M2_S3 * noise
