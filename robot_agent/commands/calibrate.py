"""`robot-agent calibrate`: a camera's file with the demonstrator that it sees in some frames."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CalibrationFile, CameraModel, LightSettings, load_calibration
from robot_agent.vision.demonstrator import Demonstrator, Skirt
from robot_agent.vision.frames import PIXEL_FORMATS, Frame
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser

MOST_FRAMES = 100
"""More add time and no colours: a skirt in one light is learnt from a few."""


def calibrate(arguments: argparse.Namespace) -> None:
    """Learn the demonstrator, write it beside the camera, and say how good that is."""
    file = load_calibration(arguments.camera)
    model, skirt = file.model(), replace(file.skirt or Skirt(), name=arguments.skirt)
    if arguments.simulated:
        frames = _simulated(model, arguments.skirt, arguments.light, arguments.seed)
    else:
        frames = read_frames(arguments.frames, model)
    learnt = learn_demonstrator(frames, model, skirt)
    write_calibration(arguments.out, replace(file, **sections(learnt.demonstrator)))
    print(
        f"wrote {arguments.out}: seen in {learnt.seen} of {learnt.frames} frames, the range to "
        f"{100 * learnt.range_sd_part:.1f} % (median), the camera {learnt.pitch_deg:+.1f} degrees up and "
        f"{learnt.roll_deg:+.1f} degrees rolled against its file"
    )


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


def calibrate_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent calibrate",
        description="Learn the colours of a demonstrator and of the light, from seconds of frames of the "
        "robot anywhere in view, 20 to 100 cm before the camera, in a white-walled compartment.",
    )
    parser.add_argument("--camera", type=Path, required=True, metavar="MODEL.toml", help="the camera's file")
    parser.add_argument("--skirt", required=True, metavar="NAME", help="what to call the colour")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--frames", type=Path, metavar="DIR", help="raw frames: *.rgb565 or *.yuyv")
    source.add_argument("--simulated", action="store_true", help="frames of the simulated camera")
    parser.add_argument("--light", default="realistic", help="of the simulated camera (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated camera (%(default)s)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.toml", help="a new calibration file")
    return parser
