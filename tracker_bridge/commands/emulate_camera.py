"""`tracker-bridge emulate camera`: pictures of a swarm with tags, and all that a rehearsal needs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from tracker_bridge.emulators.camera.calibration import board_pictures, floor_picture
from tracker_bridge.emulators.camera.floor import littered_floor, plain_floor
from tracker_bridge.emulators.camera.optics import Optics, Station
from tracker_bridge.emulators.camera.recording import PictureRecorder, RecordedSwarm
from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.emulators.camera.scene import Faults, Swarm, TagPlate
from tracker_bridge.emulators.camera.true_view import true_view
from tracker_bridge.emulators.wandering import WanderingSwarm
from tracker_bridge.overhead.settings import Calibration
from tracker_bridge.overhead.tags import TagFamily

Floats = npt.NDArray[np.float64]

ARENA_SIDE_M = 3.0
BOARDS = 15
FLOOR_TAGS_M = ((0.3, 0.3), (2.7, 0.3), (2.7, 2.7), (0.3, 2.7), (1.5, 1.5))
FLOOR_SIDE_M = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    plate, faults = TagPlate(), Faults()
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="a new folder")
    parser.add_argument("--robots", type=int, default=20, help="that wander about (%(default)s)")
    parser.add_argument(
        "--poses", type=Path, metavar="FILE.csv", help="recorded: t_s, robot, x_m, y_m, theta_rad"
    )
    parser.add_argument("--seconds", type=float, default=5.0, help="(%(default)s)")
    parser.add_argument("--frames-per-s", type=float, default=30.0, help="(%(default)s)")
    parser.add_argument("--video", action="store_true", help="one video in place of pictures")
    parser.add_argument("--boards", type=int, default=BOARDS, help="pictures of a chessboard (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    parser.add_argument("--tags", default="36h11", metavar="FAMILY", help="(%(default)s)")
    parser.add_argument("--side-mm", type=float, default=1e3 * plate.side_m, help="of a tag (%(default)s)")
    parser.add_argument(
        "--height-mm", type=float, default=1e3 * plate.height_m, help="of the tags (%(default)s)"
    )
    parser.add_argument("--litter", action="store_true", help="prints that are no tags lie on the floor")
    parser.add_argument("--exposure-ms", type=float, default=1e3 * faults.exposure_s, help="(%(default)s)")
    parser.add_argument("--defocus-px", type=float, default=faults.defocus_px, help="(%(default)s)")
    parser.add_argument(
        "--noise-levels", type=float, default=faults.noise_levels, help="of 255 (%(default)s)"
    )
    parser.add_argument(
        "--darkest", type=float, default=faults.darkest_light, help="light, of 1 (%(default)s)"
    )
    parser.add_argument(
        "--jpeg", type=int, default=faults.jpeg_quality, help="quality; 0 is none (%(default)s)"
    )


def run(arguments: argparse.Namespace) -> None:
    robots, frames = _swarm(arguments)
    family = TagFamily(arguments.tags)
    camera = _camera(arguments, family, len(robots))
    recorder = PictureRecorder(arguments.out, robots, arguments.frames_per_s, arguments.video)
    _write_calibration(arguments, camera, family, len(robots))
    (arguments.out / "overhead.toml").write_text(_settings(arguments, family, robots, recorder.source))
    ids = tuple(family.ids[: len(robots)])
    count = 0
    for poses, velocities in frames:
        recorder.write(camera.render(Swarm(ids, poses, velocities)), poses)
        count += 1
    recorder.close()
    print(f"{count} frames of {len(robots)} robots in {arguments.out}, the truth in truth.csv")
    print(f'try: [tracker] backend = "overhead" and file = "{arguments.out / "overhead.toml"}"')


def _swarm(arguments: argparse.Namespace) -> tuple[list[str], Iterator[tuple[Floats, Floats]]]:
    """The robots' names, and their poses and velocities at each frame."""
    if arguments.poses:
        recorded = RecordedSwarm.load(arguments.poses)
        return list(recorded.robots), recorded.frames(arguments.frames_per_s, arguments.seconds)
    if not 1 <= arguments.robots <= 100:
        raise UserError(f"--robots is {arguments.robots}; an arena of 3 x 3 m holds 1 to 100")
    names = [f"r{number}" for number in range(1, arguments.robots + 1)]
    count = max(1, round(arguments.seconds * arguments.frames_per_s))
    return names, islice(_wandering(arguments), count)


def _wandering(arguments: argparse.Namespace) -> Iterator[tuple[Floats, Floats]]:
    gap_m = 2 * math.sqrt(2) * _plate(arguments).half_m
    swarm = WanderingSwarm(arguments.robots, ARENA_SIDE_M, gap_m, np.random.default_rng([arguments.seed, 1]))
    while True:
        swarm.step(1 / arguments.frames_per_s)
        yield swarm.poses.copy(), swarm.velocities


def _plate(arguments: argparse.Namespace) -> TagPlate:
    return TagPlate(side_m=arguments.side_mm / 1e3, height_m=arguments.height_mm / 1e3)


def _camera(arguments: argparse.Namespace, family: TagFamily, robots: int) -> CameraRenderer:
    if robots + len(FLOOR_TAGS_M) > len(family.ids):
        raise UserError(f"the family {family.name} has {len(family.ids)} tags: too few for {robots} robots")
    rng, optics = np.random.default_rng(arguments.seed), Optics()
    faults = Faults(
        exposure_s=arguments.exposure_ms / 1e3,
        defocus_px=arguments.defocus_px,
        noise_levels=arguments.noise_levels,
        darkest_light=arguments.darkest,
        jpeg_quality=arguments.jpeg,
    )
    floor = (littered_floor if arguments.litter else plain_floor)(optics, rng)
    codes = {tag: family.code(tag) for tag in family.ids[:robots]}
    return CameraRenderer(optics, Station(), _plate(arguments), faults, codes, floor, rng)


def _write_calibration(
    arguments: argparse.Namespace, camera: CameraRenderer, family: TagFamily, robots: int
) -> None:
    """The camera as it is, and pictures to find that by."""
    folder = arguments.out
    (folder / "camera.toml").write_text(Calibration.of_view(true_view(camera)).as_toml())
    (folder / "boards").mkdir()
    for number, picture in enumerate(
        board_pictures(camera, arguments.boards, np.random.default_rng(arguments.seed))
    ):
        cv2.imwrite(str(folder / "boards" / f"{number:02}.png"), picture)
    codes = {tag: family.code(tag) for tag in _floor_ids(family, robots)}
    poses = np.array([(x_m, y_m, 0.0) for x_m, y_m in FLOOR_TAGS_M])
    cv2.imwrite(str(folder / "floor.png"), floor_picture(camera, codes, poses, FLOOR_SIDE_M))


def _floor_ids(family: TagFamily, robots: int) -> list[int]:
    return family.ids[robots : robots + len(FLOOR_TAGS_M)]


def _settings(arguments: argparse.Namespace, family: TagFamily, robots: list[str], source: str) -> str:
    lines = [
        f'family = "{arguments.tags}"',
        f"side_m = {arguments.side_mm / 1e3:g}",
        f"height_m = {arguments.height_mm / 1e3:g}",
        f"floor_side_m = {FLOOR_SIDE_M:g}",
        f'\n[[camera]]\nsource = "{source}"\ncalibration = "camera.toml"',
    ]
    lines += [
        f'\n[[tag]]\nid = {tag}\nrobot = "{robot}"' for tag, robot in zip(family.ids, robots, strict=False)
    ]
    places = zip(_floor_ids(family, len(robots)), FLOOR_TAGS_M, strict=True)
    lines += [f"\n[[floor]]\nid = {tag}\nx_m = {x_m:g}\ny_m = {y_m:g}" for tag, (x_m, y_m) in places]
    return "\n".join(lines) + "\n"
