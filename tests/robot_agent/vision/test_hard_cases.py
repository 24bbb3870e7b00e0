"""Observations that must fail: each ends with its reason in the log, and nothing is learnt from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robot_agent.drivers.interfaces import Camera
from robot_agent.drivers.sim.rendering.camera import SceneCamera, SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Post, Scene, SceneRobot
from robot_agent.offline.demonstrations import Demonstration
from robot_agent.vision.frames import Frame
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from tests.support.staged_visit import StagedVisit, demonstration, staged

HALF_WAY = 100
"""Ticks; the visit's watching takes 200."""


@pytest.fixture(scope="module")
def shown() -> Demonstration:
    return demonstration()


def nothing_learnt(visit: StagedVisit) -> str:
    """The reason, which the log has twice: with the frames, and in the visit's last word."""
    assert visit.remembered == []
    observation, last = visit.observation, visit.last_word
    assert (last.phase, last.path) == (pb.Visit.DONE, 0)
    assert not observation.moves
    assert not observation.window
    assert observation.reason == last.reason
    return last.reason


def test_with_nothing_in_the_way_the_path_is_learnt(shown: Demonstration) -> None:
    """What the other tests take something away from."""
    visit = staged(shown).run()
    assert [path.moves for path in visit.remembered] == [shown.moves]
    assert (visit.last_word.path, visit.last_word.reason, visit.observation.reason) == (7, "", "")


def test_no_robot(shown: Demonstration) -> None:
    visit = staged(shown)
    empty = Scene((visit.stage.room,))
    visit.stage.shown = lambda _: empty
    reason = nothing_learnt(visit.run())
    assert "not seen in any of 100 frames" in reason
    assert "nothing of the skirt's colour" in reason


def test_two_robots_with_the_same_skirt(shown: Demonstration) -> None:
    visit = staged(shown)
    alone = visit.stage.shown
    other = SceneRobot(Pose(0.55, 0.35, 0.0), "red")
    visit.stage.shown = lambda tick: with_body(alone(tick), other)
    assert "two or more skirts could be the demonstrator's" in nothing_learnt(visit.run())


def test_the_view_is_blocked_half_way(shown: Demonstration) -> None:
    visit = staged(shown)
    free, place = visit.stage.shown, visit.stage.place
    pillar = Post(place.x_m - 0.2, place.y_m + 0.2, "black", radius_m=0.12, height_m=0.3)
    visit.stage.shown = lambda tick: with_post(free(tick), pillar) if tick > HALF_WAY else free(tick)
    reason = nothing_learnt(visit.run())
    assert "the demonstrator was lost in" in reason


def test_the_lights_are_off(shown: Demonstration) -> None:
    visit = staged(shown)
    camera = SimulatedCamera(visit.stage.detector.model, conditions("dark"), np.random.default_rng(1))
    visit.camera = SceneCamera(camera, visit.stage.look)
    assert "the image is dark" in nothing_learnt(visit.run())


class Frozen:
    """A camera that gives its last frame for ever from some time on."""

    def __init__(self, camera: Camera, from_ns: int) -> None:
        self._camera, self._from_ns = camera, from_ns
        self._last: Frame | None = None

    def capture(self, t_ns: int) -> Frame | None:
        if t_ns < self._from_ns or self._last is None:
            self._last = self._camera.capture(t_ns)
            return self._last
        return replace(self._last, t_ns=t_ns)


def test_the_frame_is_frozen(shown: Demonstration) -> None:
    visit = staged(shown)
    visit.camera = Frozen(visit.camera, from_ns=14_000_000_000)
    visit.run()
    assert "the camera is frozen" in nothing_learnt(visit)
    assert len(visit.observation.looks) < 100, "it was given up at once"


def test_the_camera_stalls(shown: Demonstration) -> None:
    visit = staged(shown)
    living = visit.stage.shown
    visit.stage.shown = lambda tick: None if tick > HALF_WAY else living(tick)
    assert "the camera stalled" in nothing_learnt(visit.run())


def test_the_demonstrator_stands_still() -> None:
    visit = staged(demonstration(moves=())).run()
    assert "the demonstrator stood still" in nothing_learnt(visit)


@pytest.mark.parametrize("pushed_m", [0.05, 0.3])
def test_the_observer_is_pushed(shown: Demonstration, pushed_m: float) -> None:
    """By less than the pose estimate takes for a displacement, and by more."""
    visit = staged(shown)
    body, place = visit.stage.robot.body, visit.stage.place

    def push(tick: int) -> None:
        if tick == HALF_WAY:
            body.place(Pose(place.x_m + pushed_m, place.y_m, place.theta_rad))

    visit.meddle = push
    assert nothing_learnt(visit.run()) == "the observer was pushed"


def with_body(scene: Scene | None, body: SceneRobot) -> Scene:
    assert scene
    return replace(scene, bodies=(*scene.bodies, body))


def with_post(scene: Scene | None, post: Post) -> Scene:
    assert scene
    return replace(scene, posts=(*scene.posts, post))
