"""A film of one robot's learning between two of its moves: every picture from the log alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm.clock import NS_PER_S
from swarm.errors import UserError, nearest
from swarm.film.arena_view import ArenaView
from swarm.film.camera import SeenFrames, seen_frames
from swarm.film.canvas import INK, QUIET, Canvas
from swarm.film.knowledge import Knowledge
from swarm.film.pace import Pace, Span, pace
from swarm.film.panels import CameraPanel, Curve, CurvePanel, draw_memory
from swarm.film.recorded_trial import RecordedTrial, read_trial
from swarm.film.writers import write_film
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics

WIDTH, HEIGHT = 1280, 720
"""Pixels: what every player and every video service shows."""
ARENA_SIDE = 640
NOTE = (
    "shades and arrows: the best Q and its moves    orange: this journey    blue: the path that is replayed"
)
TRAIL_NS = NS_PER_S // 5
"""Between two points of the trail: a robot drives 2 cm meanwhile."""


@dataclass(frozen=True)
class FilmRequest:
    """What is filmed: a trial of a run, a learner, its moves from the first to the last."""

    run: Path
    robot: str
    first_move: int
    """0 is the trial's beginning, with a visit before the first move."""
    last_move: int
    out: Path
    trial: int = 0
    seconds: float = 30.0
    """How long the film takes."""
    frames_per_s: int = 15


@dataclass(frozen=True)
class Film:
    """What came of it."""

    file: Path
    frames: int
    speed: float
    """Times as fast as life, while the robot does not watch."""
    camera_frames: int
    """Of the robot's own camera, in the time that is filmed."""
    same_hash: int
    """Of these, those that are to the last bit what the robot saw."""

    def as_json(self) -> dict[str, Any]:
        return {**vars(self), "file": str(self.file)}


def make_film(request: FilmRequest, show: Callable[[float], object] = lambda _: None) -> Film:
    """Read the log, take the camera's frames once more, draw and write; `show` is told how far it is."""
    trial = read_trial(request.run, request.trial)
    began_ns, ended_ns = _span(trial, request)
    looks = trial.looks(request.robot)
    identity = trial.identity
    seen = seen_frames(
        trial.experiment, request.robot, identity.trial, trial.truths, looks, (began_ns, ended_ns)
    )
    count = max(2, round(request.seconds * request.frames_per_s))
    visits = _visits(trial, request.robot, (began_ns, ended_ns))
    times = pace((began_ns, ended_ns), visits, request.seconds, count)
    pictures = _pictures(trial, request, seen, times)
    write_film(request.out, request.frames_per_s, (WIDTH, HEIGHT), _watched(pictures, count, show))
    return Film(request.out, count, max(times.speeds), len(seen.frames), seen.same)


def _visits(trial: RecordedTrial, robot: str, span: Span) -> list[Span]:
    """When the robot watched, as far as that is filmed."""
    found: list[Span] = []
    for visit in trial.of(topics.OBSERVATION, robot):
        times = [look.captured_t_ns for look in visit[1].looks]
        if times and span[0] < times[0] and times[-1] < span[1]:
            found.append((times[0], times[-1]))
    return found


def _watched(
    pictures: Iterator[NDArray[np.uint8]], count: int, show: Callable[[float], object]
) -> Iterator[NDArray[np.uint8]]:
    for number, picture in enumerate(pictures, 1):
        yield picture
        show(number / count)


def _span(trial: RecordedTrial, request: FilmRequest) -> tuple[int, int]:
    """The run's times of the two moves; UserError for moves that the robot has not made."""
    learners = sorted(trial.identity.learners)
    if request.robot not in learners:
        raise UserError(
            f"{request.run}: has no learner {request.robot!r}; {nearest(request.robot, learners)}"
        )
    moves = trial.moves(request.robot)
    made = len(moves)
    if not request.first_move < request.last_move <= made:
        raise UserError(
            f"--moves {request.first_move}:{request.last_move}: {request.robot} made {made} moves; "
            "say FIRST:LAST of these, the first below the last"
        )
    began_ns = moves[request.first_move - 1][0] if request.first_move else 0
    return began_ns, moves[request.last_move - 1][0]


def _pictures(
    trial: RecordedTrial, request: FilmRequest, seen: SeenFrames, times: Pace
) -> Iterator[NDArray[np.uint8]]:
    """(rows, columns, red green blue) of each time."""
    robot = request.robot
    arena = ArenaView(trial.experiment, robot, 28, 56, ARENA_SIDE)
    camera = CameraPanel(seen, 740, 92, 400, 300)
    curve = CurvePanel(_curves(trial, robot), request.last_move, _cap(trial), 770, 456, 470, 206)
    knowledge, still = Knowledge(trial, robot), Canvas(WIDTH, HEIGHT)
    arena.draw_floor(still)
    curve.draw_axes(still)
    still.text(f"{trial.identity.run}, {robot}", (28, 14), INK, 20, bold=True)
    still.text(NOTE, (28, 701), QUIET, 12)
    for t_ns, speed in zip(times.times_ns, times.speeds, strict=True):
        canvas = still.copy()
        knowledge.learn_until(t_ns)
        _draw_arena(canvas, arena, knowledge, trial, t_ns)
        if not camera.draw(canvas, t_ns):
            draw_memory(canvas, (740, 92), knowledge.memory(t_ns), _visit_words(trial, robot, t_ns))
        last = knowledge.last(t_ns)
        curve.draw(canvas, last.number if last else 0)
        _draw_words(canvas, knowledge, t_ns, speed)
        yield canvas.pixels


def _draw_arena(
    canvas: Canvas, arena: ArenaView, knowledge: Knowledge, trial: RecordedTrial, t_ns: int
) -> None:
    arena.draw_knowledge(canvas, knowledge.q)
    _, cells = knowledge.replayed(t_ns)
    arena.draw_path(canvas, cells)
    since = range(knowledge.journey_began_ns(t_ns), t_ns, TRAIL_NS)
    trail = [trial.pose(arena.robot, then) for then in [*since, t_ns]]
    arena.draw_trail(canvas, [pose for pose in trail if pose])
    poses = [(robot.id, trial.pose(robot.id, t_ns)) for robot in trial.experiment.robot]
    arena.draw_robots(canvas, [(name, pose) for name, pose in poses if pose])


def _draw_words(canvas: Canvas, knowledge: Knowledge, t_ns: int, speed: float) -> None:
    last = knowledge.last(t_ns)
    number, track = (last.number, last.track) if last else (0, 1)
    minutes, seconds = divmod(t_ns // NS_PER_S, 60)
    canvas.text(f"move {number:,}   journey {track:,}   {minutes:,} min {seconds:02} s", (740, 17), INK, 17)
    canvas.text(f"{speed:,.0f} times as fast as life", (460, 19), QUIET, 15)


def _visit_words(trial: RecordedTrial, robot: str, t_ns: int) -> str:
    last = trial.newest(topics.VISIT, robot, t_ns)
    if last is None:
        return "it has not watched anybody yet"
    if last.phase != pb.Visit.DONE:
        return f"visit {last.visit}: it is carried to where it can watch"
    taught = f"path {last.path} was remembered" if last.path else f"nothing was remembered: {last.reason}"
    return f"visit {last.visit}: {taught}"


def _curves(trial: RecordedTrial, robot: str) -> list[Curve]:
    found = []
    for name in sorted(trial.identity.learners):
        said = {best.move: best.length for _, best in trial.of(topics.BEST_PATH, name)}
        found.append(Curve(name, sorted(said), [said[move] for move in sorted(said)], name == robot))
    return found


def _cap(trial: RecordedTrial) -> int:
    return trial.experiment.learning.path_length_cap
