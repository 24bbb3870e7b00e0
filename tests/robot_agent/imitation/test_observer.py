"""The observer follows, looks for what it does not see, and notes every frame."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.scene import Scene
from robot_agent.imitation.observer import FASTEST_TURN_RAD_PER_S, Watch
from robot_agent.offline.demonstrations import Demonstration, demonstrate
from robot_agent.offline.observation_session import (
    ObservedDemonstration,
    Stage,
    observed_demonstrations,
    offline_experiment,
)
from robot_agent.vision.detector import Detection
from robot_agent.vision.frames import Frame
from swarm.config.experiment import CopyProfile
from swarm.geometry import Move, Pose, wrap_angle_rad

TICK_NS = 100_000_000
EXPERIMENT = offline_experiment()
GRID = EXPERIMENT.compartment(EXPERIMENT.robot[0]).grid
ACROSS = (Move.NE,) * 5


def across() -> Demonstration:
    """From the south wall's middle to the east wall: across the observer's view, close to it."""
    return demonstrate(EXPERIMENT, GRID.state(3, 9), ACROSS, np.random.default_rng(1))


@pytest.fixture(scope="module")
def followed() -> ObservedDemonstration:
    return Stage(EXPERIMENT, np.random.default_rng(2)).watch(across())


def test_a_frame_every_fifth_of_a_second(followed: ObservedDemonstration) -> None:
    ticks = len(followed.demonstration.track)
    assert len(followed.watch.looks) == followed.watch.expected_frames == pytest.approx(ticks / 2, abs=1)
    assert followed.watch.failed == ""


def test_the_demonstrator_stays_in_view(followed: ObservedDemonstration) -> None:
    """Its bearing from the observer's place changes by more than a field of view; it is followed."""
    place = EXPERIMENT.observers_place(EXPERIMENT.robot[0])
    track = followed.demonstration.track
    bearings_rad = [math.atan2(pose.y_m - place.y_m, pose.x_m - place.x_m) for pose in (track[0], track[-1])]
    assert abs(wrap_angle_rad(bearings_rad[1] - bearings_rad[0])) > math.radians(53)
    assert followed.copied_moves == tuple(map(int, ACROSS))


def test_positions_lie_where_the_demonstrator_was(followed: ObservedDemonstration) -> None:
    errors_m = []
    for number, observed in enumerate(followed.watch.looks):
        if observed.position and not (isinstance(observed.answer, Detection) and observed.answer.cut_off):
            true = followed.demonstration.track[2 * number]
            errors_m.append(math.dist((observed.position.x_m, observed.position.y_m), (true.x_m, true.y_m)))
    assert len(errors_m) > 50
    assert float(np.median(errors_m)) < 0.01
    assert max(errors_m) < 0.05


class Late:
    """A camera whose frames come two frames after their exposure."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._under_way: deque[Frame | None] = deque((None, None))

    def capture(self, t_ns: int) -> Frame | None:
        self._under_way.append(self._stage.camera.capture(t_ns))
        return self._under_way.popleft()


def test_a_late_frame_is_put_where_the_turning_observer_looked_then() -> None:
    stage, shown = Stage(EXPERIMENT, np.random.default_rng(2)), across()
    stage.shown = stage.scenes(shown)
    began_ns = stage.settle()
    watch = Watch(Late(stage), stage.detector, stage.robot.pose_at, began_ns, 0.1 * len(shown.track), 5.0)
    stage.run(watch, began_ns, len(shown.track))
    errors_m = []
    for position in watch.positions:
        true = shown.track[(position.t_ns - began_ns) // TICK_NS]
        errors_m.append(math.dist((position.x_m, position.y_m), (true.x_m, true.y_m)))
    assert len(errors_m) > 50
    assert float(np.median(errors_m)) < 0.01


@dataclass
class Turning:
    """A watch, and the turning speeds that it asked for."""

    watch: Watch
    asked: list[float]

    def step(self, own_pose: Pose | None, t_ns: int) -> float:
        self.asked.append(self.watch.step(own_pose, t_ns))
        return self.asked[-1]


def test_it_looks_to_both_sides_for_a_robot_that_it_does_not_see() -> None:
    stage = Stage(EXPERIMENT, np.random.default_rng(3))
    began_ns = stage.settle()
    turning = Turning(Watch(stage.camera, stage.detector, stage.robot.pose_at, began_ns, 15.0, 5.0), [])
    headings_rad = []

    def empty(tick: int) -> Scene:
        headings_rad.append(stage.robot.body.truth(began_ns + tick * TICK_NS).theta_rad)
        return Scene((stage.room,))

    stage.shown = empty
    stage.run(turning, began_ns, 150)
    assert turning.asked[:10] == [0.0] * 10, "not in the first second"
    assert max(headings_rad) - stage.place.theta_rad > 0.45
    assert min(headings_rad) - stage.place.theta_rad < -0.45
    assert max(map(abs, turning.asked)) <= FASTEST_TURN_RAD_PER_S


def test_without_a_pose_it_takes_no_frame_and_stands() -> None:
    stage = Stage(EXPERIMENT, np.random.default_rng(3))
    watch = Watch(stage.camera, stage.detector, stage.robot.pose_at, 0, 10.0, 5.0)
    assert [watch.step(None, tick * TICK_NS) for tick in range(20)] == [0.0] * 20
    assert watch.looks == []


class Faulty:
    """A camera with some frames missing or repeated, by a word: `x` a frame, `-` none, `=` the last."""

    def __init__(self, stage: Stage, word: str) -> None:
        self._stage, self._signs = stage, iter(word)
        self._last: Frame | None = None

    def capture(self, t_ns: int) -> Frame | None:
        sign = next(self._signs)
        if sign == "-":
            return None
        if sign == "=" and self._last:
            return replace(self._last, t_ns=t_ns)
        self._last = self._stage.camera.capture(t_ns)
        return self._last


@pytest.mark.parametrize(
    ("word", "failed"),
    [
        ("xxx-----xxx", ""),
        ("xxx------xx", "the camera stalled: no frame for 6 periods"),
        ("------xxxxx", "the camera stalled: no frame for 6 periods"),
        ("xx===xx===x", ""),
        ("xx====xxxxx", "the camera is frozen: 5 equal frames"),
    ],
)
def test_a_faulty_camera_ends_the_watch(word: str, failed: str) -> None:
    """A few frames may be missing, or read twice, without harm."""
    stage = Stage(EXPERIMENT, np.random.default_rng(3))
    stage.shown = stage.scenes(across())
    began_ns = stage.settle()
    watch = Watch(Faulty(stage, word), stage.detector, stage.robot.pose_at, began_ns, len(word) / 5, 5.0)
    stage.run(watch, began_ns, 2 * len(word))
    assert watch.failed == failed
    assert watch.ended(began_ns + 2 * len(word) * TICK_NS)


@pytest.mark.parametrize("kind", ["random", "expert"])
def test_rendered_demonstrations_are_copied(kind: str) -> None:
    """Six of the benchmark's (tests/benchmarks/rendered_copying.py), which allows one list in a hundred."""
    for observed in observed_demonstrations(EXPERIMENT, kind, 6, seed=1):
        assert observed.copied_moves == tuple(map(int, observed.demonstration.moves))


@pytest.mark.long
def test_the_papers_way_copies_worse() -> None:
    """Small frames, counted pixels and regression lines: many lists are wrong, and few are refused."""
    experiment = offline_experiment(CopyProfile.PAPER)
    shown = list(observed_demonstrations(experiment, "random", 20, seed=1))
    perfect = sum(each.copied_moves == tuple(map(int, each.demonstration.moves)) for each in shown)
    assert 0 < perfect < 20
    assert sum(bool(each.copied_moves) for each in shown) >= 15
