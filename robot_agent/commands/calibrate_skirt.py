"""`robot-agent calibrate skirt`: a colour table for a skirt, learnt from frames of it."""

from __future__ import annotations

import argparse
from itertools import islice
from pathlib import Path

import numpy as np

from robot_agent.vision.camera_model import CameraModel, load_camera_model
from robot_agent.vision.colour_calibration import learn_colour_table
from robot_agent.vision.colour_table import SKIRT
from robot_agent.vision.frames import PIXEL_FORMATS, Frame
from swarm.clock import unix_clock
from swarm.config.arguments import place, seed
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser

CHANNELS = ("red", "green", "blue")
LIVE_FRAMES = 10
"""Enough for a skirt in one light."""
LIVE_TICK_S = 0.1
LIVE_TICKS = 50
"""Five seconds, in which even a slow camera gives some frames."""
MOST_FRAMES = 100
"""More add time and no colours: a skirt in one light is learnt from a few."""


def calibrate_skirt(arguments: argparse.Namespace) -> None:
    """Learn the table, write it, and say how it came out."""
    model = load_camera_model(arguments.camera)
    if arguments.simulated:
        frames = _simulated(model, arguments.skirt, arguments.light, arguments.seed)
    elif arguments.live:
        frames = live_frames(arguments.live, model)
    else:
        frames = read_frames(arguments.frames, model)
    table = learn_colour_table(frames, model, arguments.skirt)
    table.save(arguments.out)
    share = float(np.mean(table.kinds == SKIRT))
    print(
        f"wrote {arguments.out}: {len(frames)} frames, {100 * share:.1f} % of all colours are the skirt's, "
        f"edges are measured in {CHANNELS[table.edge_channel]}"
    )


def live_frames(camera: str, model: CameraModel) -> list[Frame]:
    """Frames of a camera such as /dev/video0, of the model's size; UserError if it gives none."""
    from robot_agent.drivers.cameras.choice import frames_of
    from robot_agent.drivers.cameras.fitted import fitted

    take = frames_of(camera, None)
    taken = (take() for _ in islice(unix_clock().ticks(LIVE_TICK_S), LIVE_TICKS))
    frames = list(islice((fitted(frame, model) for frame in taken if frame), LIVE_FRAMES))
    if not frames:
        raise UserError(f"{camera}: no frame in {LIVE_TICK_S * LIVE_TICKS:g} s: is the camera plugged in?")
    return frames


def read_frames(directory: Path, model: CameraModel) -> list[Frame]:
    """Raw frames, one a file, named *.rgb565 or *.yuyv after their format; UserError if there are none."""
    paths = sorted(path for name in PIXEL_FORMATS for path in directory.glob(f"*.{name}"))[:MOST_FRAMES]
    if not paths:
        raise UserError(f"{directory}: holds no frame (*.rgb565 or *.yuyv); is it the right directory?")
    return [_read(path, model) for path in paths]


def _read(path: Path, model: CameraModel) -> Frame:
    try:
        return Frame(0, model.width, model.height, path.suffix[1:], path.read_bytes())
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise UserError(f"{path}: {error}; use the camera file of that size") from error


def _simulated(model: CameraModel, skirt: str, light: str, seed: int) -> list[Frame]:
    from robot_agent.drivers.sim.camera import CALIBRATION_RANGES_M
    from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
    from robot_agent.drivers.sim.rendering.conditions import conditions

    camera = SimulatedCamera(model, conditions(light), np.random.default_rng(seed))
    return calibration_frames(camera, skirt, CALIBRATION_RANGES_M)


def calibrate_skirt_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent calibrate skirt",
        description="Learn the colour of a skirt. Put the robot that wears it 20 to 50 cm straight ahead of "
        "the camera, in a white-walled compartment, and keep a few frames.",
    )
    parser.add_argument("--camera", type=Path, required=True, metavar="MODEL.toml", help="the camera's file")
    parser.add_argument("--skirt", required=True, metavar="NAME", help="what to call the colour")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--frames", type=Path, metavar="DIR", help="raw frames: *.rgb565 or *.yuyv")
    source.add_argument("--live", default="", metavar="CAMERA", help="/dev/videoN, or a video of the skirt")
    source.add_argument("--simulated", action="store_true", help="frames of the simulated camera")
    parser.add_argument("--light", default="realistic", help="of the simulated camera (%(default)s)")
    parser.add_argument("--seed", type=seed, default=1, help="of the simulated camera (%(default)s)")
    parser.add_argument("--out", type=place, required=True, metavar="FILE.npz", help="a new colour table")
    return parser
