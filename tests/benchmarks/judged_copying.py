"""How well films of another renderer are copied; `python -m tests.benchmarks.judged_copying`.

Prints one JSON line: for each row of the judging renderer the shares of random five-move demonstrations whose
list was copied whole (`perfect`), otherwise than shown (`wrong`) or not at all (`refused`, with the reasons).
The observer stands still and knows its pose. `--profile paper` takes 160 x 120 frames and counts pixels.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import replace

import cv2
import numpy as np

from robot_agent.imitation.copying import Copy, NoCopy, copy_moves
from robot_agent.imitation.observer import VAGUE_M
from robot_agent.imitation.positions import ObservedPosition, position_from_detection
from robot_agent.vision.detector import MEASUREMENTS, Detection, Detector
from robot_agent.vision.frames import Frame
from swarm.clock import NS_PER_S
from swarm.config.experiment import CopyProfile
from swarm.geometry import Pose
from tests.benchmarks.judged_seeing import calibrated, camera_of, file_of
from tests.support.judge.conditions import Condition, conditions
from tests.support.judge.demonstrations import COMPARTMENT, frames, random_demonstration

ROWS = (
    "black hat",
    "yellow hat on the skirt",
    "white hat",
    "strongly warm",
    "exposure 0.3",
    "pitch 3",
    "roll 3",
    "blur 2",
    "noise x3",
    "six posts",
    "640x480",
    "hard",
)
"""One or two of each kind: a demonstration is some sixty frames."""


def copied(
    condition: Condition, profile: CopyProfile, detector: Detector, number: int, seed: int
) -> tuple[tuple[int, ...], Copy | NoCopy]:
    """The moves that were shown, and what came of them."""
    generator, camera = np.random.default_rng([seed, number, 3]), camera_of(condition)
    shown = random_demonstration(generator, camera)
    detector.reset()
    positions = []
    for filmed in frames(shown, condition, camera, generator):
        t_ns = round(filmed.t_s * NS_PER_S)
        size = (condition.width, condition.height)
        frame = Frame(t_ns, *size, condition.sensor.pixel_format, filmed.data)
        positions += _position(shown.observer, detector, detector.look(frame, turned_rad=0.0))
    moves = tuple(int(move) for move in shown.moves)
    return moves, copy_moves(positions, profile, COMPARTMENT.cell_m, len(shown.poses))


def _position(observer: Pose, detector: Detector, answer: object) -> list[ObservedPosition]:
    """None of what was not seen, or half hidden and far away: as the observer does it."""
    if not isinstance(answer, Detection) or (answer.cut_off and answer.range_sd_m > VAGUE_M):
        return []
    seen = (answer.range_m, answer.bearing_rad, answer.range_sd_m, answer.bearing_sd_rad, answer.t_ns)
    return [position_from_detection(observer, detector.model.forward_m, *seen)]


def score(condition: Condition, profile: CopyProfile, count: int, seed: int) -> dict[str, object]:
    """The figures of one row; the light and the tilt are learnt by one detector over all demonstrations."""
    if profile is CopyProfile.PAPER:
        measurement = MEASUREMENTS[profile]
        condition = replace(condition, width=measurement.width, height=measurement.height)
    detector = Detector(profile, file_of(condition), calibrated(condition, seed))
    lists = [copied(condition, profile, detector, number, seed) for number in range(count)]
    reasons = Counter(copy.reason for _, copy in lists if isinstance(copy, NoCopy))
    pairs = [(moves, tuple(map(int, copy.path().moves))) for moves, copy in lists if isinstance(copy, Copy)]
    perfect = sum(moves == copy for moves, copy in pairs)
    return {
        "perfect": round(perfect / count, 3),
        "wrong": round((len(pairs) - perfect) / count, 3),
        "refused": round(1 - len(pairs) / count, 3),
        "reasons": dict(reasons),
    }


def main() -> None:
    rows = conditions()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=50)
    parser.add_argument("--profile", type=CopyProfile, default=CopyProfile.BEST, choices=list(CopyProfile))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rows", nargs="+", default=list(ROWS), choices=list(rows))
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    chosen = (arguments.profile, arguments.demonstrations, arguments.seed)
    scores = {name: score(rows[name], *chosen) for name in arguments.rows}
    settings = {
        "profile": arguments.profile.value,
        "demonstrations": arguments.demonstrations,
        "seed": arguments.seed,
    }
    print(json.dumps({"benchmark": "judged_copying", **settings, "rows": scores}))


if __name__ == "__main__":
    main()
