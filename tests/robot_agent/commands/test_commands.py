"""`robot-agent calibrate` and `robot-agent collect-copies`: the tools beside the robot."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.vision.camera_model import load_calibration, load_camera_model
from robot_agent.vision.pixels import frame_pixels
from swarm.surrogate.copies import load_copies
from tests.support.swarm_runs import ROOT

CAMERA = ROOT / "deploy" / "cameras" / "epuck_320x240.toml"


def robot_agent(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "robot_agent", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def calibrate(*arguments: str) -> subprocess.CompletedProcess[str]:
    return robot_agent("calibrate", "--camera", str(CAMERA), "--skirt", "green", *arguments)


def test_a_demonstrator_is_learnt_from_a_directory_of_frames(tmp_path: Path) -> None:
    """The same frames, written by a camera, give the same file as the simulated camera's own.

    `calibrate` alone is the older form of `calibrate skirt`.
    """
    camera = SimulatedCamera(load_camera_model(CAMERA), conditions("realistic"), np.random.default_rng(5))
    for number, frame in enumerate(calibration_frames(camera, "green", (0.2, 0.25, 0.3, 0.4, 0.5))):
        (tmp_path / f"{number}.rgb565").write_bytes(frame.data)
    done = calibrate("--frames", str(tmp_path), "--out", str(tmp_path / "a.toml"))
    assert done.returncode == 0, done.stderr
    assert "seen in 5 of 5 frames" in done.stdout
    done = robot_agent(
        "calibrate",
        "skirt",
        "--camera",
        str(CAMERA),
        "--skirt",
        "green",
        "--simulated",
        "--seed",
        "5",
        "--out",
        str(tmp_path / "b.toml"),
    )
    assert done.returncode == 0, done.stderr
    one, other = load_calibration(tmp_path / "a.toml"), load_calibration(tmp_path / "b.toml")
    assert one == other
    assert one.model() == load_camera_model(CAMERA)
    demonstrator = one.demonstrator()
    assert demonstrator is not None
    assert demonstrator.skirt.name == "green"
    assert demonstrator.skirt.colour[1] > 3 * max(demonstrator.skirt.colour[::2])
    assert demonstrator.hat is not None
    assert demonstrator.hat.stands_out


def test_a_demonstrator_is_learnt_from_a_camera_that_runs(tmp_path: Path) -> None:
    """Pictures in a folder stand in for the camera."""
    camera = SimulatedCamera(load_camera_model(CAMERA), conditions("realistic"), np.random.default_rng(5))
    for number, frame in enumerate(calibration_frames(camera, "green", (0.2, 0.3, 0.4))):
        cv2.imwrite(str(tmp_path / f"{number}.png"), cv2.cvtColor(frame_pixels(frame), cv2.COLOR_RGB2BGR))
    done = calibrate("--live", str(tmp_path), "--out", str(tmp_path / "live.toml"))
    assert done.returncode == 0, done.stderr
    assert "of 3 frames" in done.stdout
    demonstrator = load_calibration(tmp_path / "live.toml").demonstrator()
    assert demonstrator is not None
    assert demonstrator.skirt.name == "green"


@pytest.mark.parametrize(
    ("files", "reason"),
    [
        ({}, "holds no frame"),
        ({"0.rgb565": b"short"}, r"frame has 153600 bytes"),
        ({"0.png": b""}, "holds no frame"),
    ],
)
def test_frames_that_cannot_be_used_are_refused(files: dict[str, bytes], reason: str, tmp_path: Path) -> None:
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    done = calibrate("--frames", str(tmp_path), "--out", str(tmp_path / "new.toml"))
    assert done.returncode == 2
    assert reason in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "new.toml").exists()


def test_frames_or_simulation_must_be_said(tmp_path: Path) -> None:
    done = calibrate("--out", str(tmp_path / "new.toml"))
    assert done.returncode == 2
    assert "robot-agent calibrate skirt --help" in done.stderr


def test_copies_are_collected_with_how_they_were_made(tmp_path: Path) -> None:
    out = tmp_path / "copies.csv"
    done = robot_agent("collect-copies", "--out", str(out), "--demonstrations", "2", "--seed", "3")
    assert done.returncode == 0, done.stderr
    pairs = load_copies(out).pairs
    assert [pair.kind for pair in pairs] == ["random"] * 2 + ["expert"] * 2
    assert all(len(pair.true) == 5 for pair in pairs)
    assert "--demonstrations 2 --profile best --light realistic --seed 3" in out.read_text()
    again = robot_agent("collect-copies", "--out", str(out), "--demonstrations", "2")
    assert again.returncode == 2
    assert "is there already" in again.stderr


def test_help_of_the_robot_tells_of_its_tools() -> None:
    text = robot_agent("--help").stdout
    assert "calibrate" in text
    assert "collect-copies" in text
    assert "--keys" in text
