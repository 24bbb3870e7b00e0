"""How surely hats are told apart; run with `python -m tests.benchmarks.hats`. Prints one JSON line.

A name is wrong if its robot is not where the hat is said to be. The clouds are made by the emulator
(`tracker_bridge.emulators.marker_clouds`), which knows nothing of how hats are found.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import time
from collections import Counter

import numpy as np

from swarm.geometry import wrap_angle_rad
from tracker_bridge.emulators.marker_clouds import CloudFaults, MarkerClouds
from tracker_bridge.emulators.wandering import WanderingSwarm
from tracker_bridge.hats.design import design_hats
from tracker_bridge.hats.hat_tracking import HatTracker
from tracker_bridge.hats.patterns import Hat, PinGrid, difference_m

ARENA_SIDE_M = 3.0
GAP_M = 0.071
"""Between the axes of e-pucks that touch."""
RATE_HZ = 100
WRONG_M = 0.03
"""Further away than this stands no robot but another one, or none."""


def distinguishable_at_m(hats: list[Hat]) -> float:
    """The smallest difference between two of some hats."""
    pins = np.array([hat.pins for hat in hats])
    return float((difference_m(pins, pins) + np.eye(len(hats))).min())


def run(hats: list[Hat], frames: int, faults: CloudFaults, seed: int) -> dict[str, float]:
    """Follow a wandering swarm with these hats and count."""
    rng = np.random.default_rng(seed)
    swarm = WanderingSwarm(len(hats), ARENA_SIDE_M, GAP_M, rng)
    clouds = MarkerClouds(np.array([hat.pins for hat in hats]), ARENA_SIDE_M, faults, rng)
    tracker, numbers = HatTracker(hats, faults.noise_m), {hat.name: number for number, hat in enumerate(hats)}
    named, wrong, cpu_s, told = 0, 0, 0.0, Counter[str]()
    errors_m, errors_rad = [], []
    for frame in range(frames):
        swarm.step(1 / RATE_HZ)
        cloud = clouds.cloud(swarm.poses, 1 / RATE_HZ)
        began = time.process_time()
        tracked, events = tracker.update(cloud, (frame + 1) * 1_000_000_000 // RATE_HZ)
        cpu_s += time.process_time() - began
        told.update(event.kind for event in events)
        for hat in tracked:
            x_m, y_m, theta_rad = swarm.poses[numbers[hat.name]]
            errors_m.append(math.hypot(hat.pose.x_m - x_m, hat.pose.y_m - y_m))
            errors_rad.append(abs(wrap_angle_rad(hat.pose.theta_rad - theta_rad)))
            wrong += errors_m[-1] > WRONG_M
        named += len(tracked)
    return {
        "identified": named / (frames * len(hats)),
        "wrong": wrong,
        "position_p99_mm": 1e3 * float(np.percentile(errors_m, 99)),
        "heading_p99_deg": math.degrees(float(np.percentile(errors_rad, 99))),
        "times_real_time": frames / RATE_HZ / cpu_s,
        **{f"told_{kind.replace(' ', '_')}": count for kind, count in sorted(told.items())},
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=60_000)
    parser.add_argument("--hats", type=int, default=50)
    parser.add_argument("--noise-mm", type=float, default=1.0)
    parser.add_argument("--dropout", type=float, default=0.05)
    parser.add_argument("--flashes", type=float, default=5.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    hats = design_hats(PinGrid(), options.hats)
    faults = dataclasses.replace(
        CloudFaults(), noise_m=1e-3 * options.noise_mm, dropout=options.dropout, flashes=options.flashes
    )
    figures = {
        "benchmark": "hats",
        **vars(options),
        "hats_differ_by_mm": 1e3 * distinguishable_at_m(hats),
        **run(hats, options.frames, faults, options.seed),
    }
    print(json.dumps({name: round(v, 5) if isinstance(v, float) else v for name, v in figures.items()}))


if __name__ == "__main__":
    main()
