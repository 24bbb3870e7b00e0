"""Colour tables: learnt from frames, kept in files, and refused when they are anything else."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.vision.camera_model import load_camera_model
from robot_agent.vision.colour_calibration import learn_colour_table
from robot_agent.vision.colour_table import PALE, SKIRT, ColourTable, load_colour_table
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import WORDS, frame_words
from swarm.errors import UserError
from tests.benchmarks.seeing import CALIBRATION

MODEL = load_camera_model(CALIBRATION)


@pytest.fixture(scope="module")
def camera() -> SimulatedCamera:
    return SimulatedCamera(MODEL, conditions("realistic"), np.random.default_rng(5))


@pytest.mark.parametrize(
    ("skirt", "channels"),
    [("red", {1}), ("blue", {1}), ("green", {0, 2}), ("yellow", {2}), ("magenta", {1})],
)
def test_a_table_knows_skirt_from_wall(camera: SimulatedCamera, skirt: str, channels: set[int]) -> None:
    frames = calibration_frames(camera, skirt, (0.25, 0.35))
    table = learn_colour_table(frames, MODEL, skirt)
    kinds = table.kinds[frame_words(frames[0])]
    assert (kinds[117:123, 140:180] == SKIRT).mean() > 0.95
    assert (kinds[112:118, :80] == PALE).mean() > 0.95
    assert not (kinds[112:118, :80] == SKIRT).any()
    assert table.edge_channel in channels


def test_a_saved_table_is_read_back_and_never_overwritten(tmp_path: Path) -> None:
    kinds = np.random.default_rng(1).integers(0, 3, WORDS).astype(np.uint8)
    path = tmp_path / "red.npz"
    ColourTable("red", kinds, 1).save(path)
    table = load_colour_table(path)
    assert (table.skirt, table.edge_channel) == ("red", 1)
    assert np.array_equal(table.kinds, kinds)
    with pytest.raises(UserError, match="is there already"):
        table.save(path)


def _write(path: Path, **arrays: np.ndarray) -> None:
    good = {
        "skirt": np.frombuffer(b"red", dtype=np.uint8),
        "kinds": np.zeros(WORDS, dtype=np.uint8),
        "edge_channel": np.array([1], dtype=np.uint8),
    }
    np.savez_compressed(path, **(good | arrays))


@pytest.mark.parametrize(
    "arrays",
    [
        {"kinds": np.zeros(WORDS - 1, dtype=np.uint8)},
        {"kinds": np.zeros(WORDS, dtype=np.uint16)},
        {"kinds": np.full(WORDS, 3, dtype=np.uint8)},
        {"kinds": np.array([{"a": 1}], dtype=object)},
        {"edge_channel": np.array([3], dtype=np.uint8)},
        {"edge_channel": np.array([], dtype=np.uint8)},
        {"skirt": np.frombuffer(b"\xff\xfe", dtype=np.uint8)},
        {"kinds": np.zeros(1 << 24, dtype=np.uint8)},
    ],
)
def test_a_file_of_another_content_is_refused_by_name(arrays: dict[str, np.ndarray], tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    _write(path, **arrays)
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path)


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04broken"])
def test_a_file_that_is_no_table_is_refused_by_name(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    path.write_bytes(content)
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path)


def test_a_missing_array_or_file_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("other.npy", b"")
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path)
    with pytest.raises(UserError, match=r"gone\.npz cannot be used"):
        load_colour_table(tmp_path / "gone.npz")


def test_learning_says_what_is_wrong_with_the_frames(camera: SimulatedCamera) -> None:
    with pytest.raises(UserError, match="no frame"):
        learn_colour_table([], MODEL, "red")
    with pytest.raises(UserError, match="calibration for 160 x 120"):
        learn_colour_table(calibration_frames(camera, "red", (0.3,)), MODEL.scaled(160, 120), "red")
    with pytest.raises(UserError, match="no colour of its own"):
        learn_colour_table(calibration_frames(camera, "white", (0.3,)), MODEL, "white")
    noise = np.random.default_rng(1).integers(0, 256, 320 * 240 * 2, dtype=np.uint8)
    with pytest.raises(UserError, match="20 to 50 cm straight ahead"):
        learn_colour_table([Frame(0, 320, 240, "rgb565", noise.tobytes())], MODEL, "red")
