"""`robot-agent calibrate`: a colour table for a skirt, learnt from frames of it."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from robot_agent.vision.camera_model import CameraModel, load_camera_model
from robot_agent.vision.colour_calibration import learn_colour_table
from robot_agent.vision.colour_table import SKIRT
from robot_agent.vision.frames import PIXEL_FORMATS, Frame
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser

CHANNELS = ("red", "green", "blue")
MOST_FRAMES = 100
"""More add time and no colours: a skirt in one light is learnt from a few."""


def calibrate(arguments: argparse.Namespace) -> None:
    """Learn the table, write it, and say how it came out."""
    model = load_camera_model(arguments.camera)
    if arguments.simulated:
        frames = _simulated(model, arguments.skirt, arguments.light, arguments.seed)
    else:
        frames = read_frames(arguments.frames, model)
    table = learn_colour_table(frames, model, arguments.skirt)
    table.save(arguments.out)
    share = float(np.mean(table.kinds == SKIRT))
    print(
        f"wrote {arguments.out}: {len(frames)} frames, {100 * share:.1f} % of all colours are the skirt's, "
        f"edges are measured in {CHANNELS[table.edge_channel]}"
    )


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


def calibrate_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent calibrate",
        description="Learn the colour of a skirt. Put the robot that wears it 20 to 50 cm straight ahead of "
        "the camera, in a white-walled compartment, and keep a few frames.",
    )
    parser.add_argument("--camera", type=Path, required=True, metavar="MODEL.toml", help="the camera's file")
    parser.add_argument("--skirt", required=True, metavar="NAME", help="what to call the colour")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--frames", type=Path, metavar="DIR", help="raw frames: *.rgb565 or *.yuyv")
    source.add_argument("--simulated", action="store_true", help="frames of the simulated camera")
    parser.add_argument("--light", default="realistic", help="of the simulated camera (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated camera (%(default)s)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.npz", help="a new colour table")
    return parser
