"""A film shows what the log says: what the robot knew, what it remembered, and what its camera saw."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image, ImageSequence
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.errors import UserError
from swarm.film.camera import seen_frames
from swarm.film.film import FilmRequest, make_film
from swarm.film.knowledge import Knowledge
from swarm.film.pace import VISIT_S, pace
from swarm.film.recorded_trial import RecordedTrial, read_trial
from swarm.film.writers import write_film
from swarm.replay.replay import Request, replay_log
from tests.conftest import SmallRun
from tests.support.learnt_logs import ROBOT, learnt_log

S = 1_000_000_000
PUPIL = "pupil"
EVER = (0, 10**18)


@pytest.fixture(scope="module")
def watching(watching_run: SmallRun) -> RecordedTrial:
    return read_trial(watching_run.directory, 0)


def test_the_camera_s_frames_are_those_that_the_robot_saw(watching: RecordedTrial) -> None:
    looks = watching.looks(PUPIL)
    seen = seen_frames(watching.experiment, PUPIL, 0, watching.truths, looks, EVER)
    assert len(seen.frames) == len(looks) == seen.same == 100
    widths = {frame.pixels.shape[1] for frame in seen.frames}
    columns = [frame.column for frame in seen.frames if frame.column is not None]
    assert widths == {320}
    assert len(columns) > 50
    assert all(-1 <= column <= 320 for column in columns)


def test_another_seed_s_frames_are_others(watching: RecordedTrial) -> None:
    other = watching.experiment.changed(seed=2)
    seen = seen_frames(other, PUPIL, 0, watching.truths, watching.looks(PUPIL), EVER)
    assert (len(seen.frames), seen.same) == (100, 0)


def test_a_robot_whose_camera_is_not_known_has_none(watching: RecordedTrial) -> None:
    looks, real = watching.looks(PUPIL), watching.experiment
    experiment = replace(real, robot=tuple(replace(robot, driver="serial") for robot in real.robot))
    assert not seen_frames(experiment, PUPIL, 0, watching.truths, looks, EVER).frames


def test_what_is_known_is_what_the_learner_knew(tmp_path: Path) -> None:
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 240)
    trial = read_trial(log, 0)
    knowledge = Knowledge(trial, ROBOT)
    for at in (40, 100, 240):
        t_ns = trial.moves(ROBOT)[at - 1][0]
        knowledge.learn_until(t_ns)
        controller = replay_log(Request((log,), ROBOT, at)).replays[ROBOT].learner.controller
        assert knowledge.q.values == controller.q.values
        ratios = {line.path: line.ratio for line in knowledge.memory(t_ns)}
        known = {each.number: controller.memory.ratio(each) for each in controller.memory.remembered}
        assert {path: ratios[path] for path in known if path in ratios} == {
            path: ratio for path, ratio in known.items() if path in ratios
        }
        assert known.keys() - ratios.keys() <= {max(known)}, "a path that came with the visit after this move"


def test_a_film_is_even_without_visits() -> None:
    even = pace((10 * S, 110 * S), [], 10.0, 11)
    assert list(even.times_ns) == [10 * S * number for number in range(1, 12)]
    assert set(even.speeds) == {10.0}


def test_a_film_takes_its_time_for_visits() -> None:
    times = pace((0, 1000 * S), [(300 * S, 330 * S)], 20.0, 201)
    inside = [t_ns for t_ns in times.times_ns if 300 * S < t_ns < 330 * S]
    assert len(inside) == pytest.approx(10 * VISIT_S, abs=1)
    assert (times.times_ns[0], times.times_ns[-1]) == (0, 1000 * S)
    assert sorted(times.times_ns) == list(times.times_ns)
    assert min(times.speeds) == pytest.approx(30 / VISIT_S)
    assert max(times.speeds) == pytest.approx(970 / (20 - VISIT_S))
    many = [(100 * number * S, (100 * number + 30) * S) for number in range(1, 9)]
    crowded = pace((0, 1000 * S), many, 10.0, 1001)
    assert np.mean(np.array(crowded.speeds) == min(crowded.speeds)) == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_what_is_written_can_be_watched(tmp_path: Path, name: str) -> None:
    shades = (0, 60, 120, 180, 240)
    pictures = (np.full((240, 320, 3), shade, dtype=np.uint8) for shade in shades)
    file = tmp_path / name
    write_film(file, 10, (320, 240), pictures)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    seen = shades_of(file)
    assert seen == pytest.approx(list(shades), abs=6)


def shades_of(file: Path) -> list[float]:
    """The mean of each picture."""
    if file.suffix == ".gif":
        with Image.open(file) as gif:
            return [float(np.mean(np.array(one.convert("RGB")))) for one in ImageSequence.Iterator(gif)]
    film = cv2.VideoCapture(str(file))
    pictures = iter(film.read, (False, None))
    return [float(picture.mean()) for _, picture in pictures]


def test_the_command_films_a_visit(watching_run: SmallRun, tmp_path: Path) -> None:
    out = tmp_path / "visit.gif"
    words = ["--robot", PUPIL, "--moves", "0:4", "--seconds", "0.6", "--rate", "5", "--out", str(out)]
    said = json.loads(CliRunner().invoke(app, ["film", str(watching_run.directory), *words, "--json"]).output)
    assert (said["frames"], said["camera_frames"], said["same_hash"]) == (3, 100, 100)
    with Image.open(out) as gif:
        assert gif.size == (800, 450)


def test_a_log_without_poses_is_filmed_too(tmp_path: Path) -> None:
    log = tmp_path / "trial-000.mcap"
    learnt_log(log, 40)
    film = make_film(FilmRequest(log, ROBOT, 10, 40, tmp_path / "a.gif", seconds=0.4, frames_per_s=5))
    assert (film.frames, film.camera_frames) == (2, 0)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--robot", "pupl", "--moves", "1:4"), "has no learner 'pupl'; did you mean 'pupil'?"),
        (("--robot", PUPIL, "--moves", "1:40"), "pupil made 4 moves"),
        (("--robot", PUPIL, "--moves", "4:1"), "is no FIRST:LAST"),
        (("--robot", PUPIL, "--moves", "one"), "is no FIRST:LAST"),
        (("--robot", PUPIL, "--moves", "1:4", "--out", "x.avi"), "written as .mp4 or .gif"),
        (("--robot", PUPIL, "--moves", "1:4", "--trial", "3"), "has no trial 3"),
    ],
)
def test_what_cannot_be_filmed_says_why(watching_run: SmallRun, words: tuple[str, ...], told: str) -> None:
    done = CliRunner().invoke(app, ["film", str(watching_run.directory), *words])
    said = str(done.exception) if isinstance(done.exception, UserError) else done.output
    assert told in " ".join(said.replace("│", " ").split())
