"""`robot-agent calibrate skirt`: a camera's file with the demonstrator that it sees in some frames."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CalibrationFile, CameraModel, LightSettings, load_calibration
from robot_agent.vision.demonstrator import Demonstrator, Skirt
from robot_agent.vision.frames import PIXEL_FORMATS, Frame
from swarm.clock import unix_clock
from swarm.config.arguments import place, seed
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser

LIVE_FRAMES = 10
"""Enough for a skirt in one light."""
LIVE_TICK_S = 0.1
LIVE_TICKS = 50
"""Five seconds, in which even a slow camera gives some frames."""
MOST_FRAMES = 100
"""More add time and no colours: a skirt in one light is learnt from a few."""


def calibrate_skirt(arguments: argparse.Namespace) -> None:
    """Learn the demonstrator, write it beside the camera, and say how good that is."""
    file = load_calibration(arguments.camera)
    model, skirt = file.model(), replace(file.skirt or Skirt(), name=arguments.skirt)
    if arguments.simulated:
        frames = _simulated(model, arguments.skirt, arguments.light, arguments.seed)
    elif arguments.live:
        frames = live_frames(arguments.live, model)
    else:
        frames = read_frames(arguments.frames, model)
    learnt = learn_demonstrator(frames, model, skirt)
    write_calibration(arguments.out, replace(file, **sections(learnt.demonstrator)))
    print(
        f"wrote {arguments.out}: seen in {learnt.seen} of {learnt.frames} frames, the range to "
        f"{100 * learnt.range_sd_part:.1f} % (median), the camera {learnt.pitch_deg:+.1f} degrees up and "
        f"{learnt.roll_deg:+.1f} degrees rolled against its file"
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


def sections(demonstrator: Demonstrator) -> dict[str, Any]:
    """The tables of a calibration file that tell of the demonstrator."""
    light = LightSettings(demonstrator.white)
    return {"skirt": demonstrator.skirt, "hat": demonstrator.hat, "light": light}


def write_calibration(path: Path, calibration: CalibrationFile) -> None:
    """A new TOML file; UserError if it is there already or cannot be made."""
    tables = [
        f"[{table}]\n" + "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())
        for table, values in asdict(calibration).items()
        if values is not None
    ]
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write("\n".join(tables))
    except FileExistsError as error:
        raise UserError(f"calibration {path} is there already: choose another name or remove it") from error
    except OSError as error:
        raise UserError(f"calibration {path}: cannot be written ({error.strerror})") from error


def _toml(value: str | float | tuple[float, ...]) -> str:
    return json.dumps(value)


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
        description="Learn the colours of a demonstrator and of the light, from seconds of frames of the "
        "robot anywhere in view, 20 to 100 cm before the camera, in a white-walled compartment.",
    )
    parser.add_argument("--camera", type=Path, required=True, metavar="MODEL.toml", help="the camera's file")
    parser.add_argument("--skirt", required=True, metavar="NAME", help="what to call the colour")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--frames", type=Path, metavar="DIR", help="raw frames: *.rgb565 or *.yuyv")
    source.add_argument("--live", default="", metavar="CAMERA", help="/dev/videoN, or a video of the skirt")
    source.add_argument("--simulated", action="store_true", help="frames of the simulated camera")
    parser.add_argument("--light", default="realistic", help="of the simulated camera (%(default)s)")
    parser.add_argument("--seed", type=seed, default=1, help="of the simulated camera (%(default)s)")
    parser.add_argument(
        "--out", type=place, required=True, metavar="FILE.toml", help="a new calibration file"
    )
    return parser
