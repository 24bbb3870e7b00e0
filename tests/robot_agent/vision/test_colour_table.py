"""Colour tables of former versions: read as a demonstrator, and refused when they are anything else."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from robot_agent.vision.colour_table import PALE, SKIRT, load_colour_table
from robot_agent.vision.pixels import WORDS, word_colours
from swarm.errors import UserError


def _write(path: Path, **arrays: np.ndarray) -> None:
    """As `calibrate` wrote them; by default, whatever is nearly red and whatever is nearly grey."""
    red, green, blue = word_colours().T
    kinds = np.zeros(WORDS, dtype=np.uint8)
    kinds[(red > 0.5) & (green < 0.3) & (blue < 0.3)] = SKIRT
    kinds[(abs(red - green) < 0.05) & (abs(blue - green) < 0.05) & (green > 0.5)] = PALE
    good = {
        "skirt": np.frombuffer(b"red", dtype=np.uint8),
        "kinds": kinds,
        "edge_channel": np.array([1], dtype=np.uint8),
    }
    np.savez_compressed(path, **(good | arrays))


def test_a_table_tells_of_a_demonstrator(tmp_path: Path) -> None:
    path = tmp_path / "red.npz"
    _write(path)
    found = load_colour_table(path, gamma=2.2)
    assert found.skirt.name == "red"
    assert found.skirt.colour[0] > 5 * max(found.skirt.colour[1:])
    assert found.skirt.edge_channel == 1
    assert max(found.white) < 1.1 * min(found.white)
    assert found.hat is None


@pytest.mark.parametrize(
    "arrays",
    [
        {"kinds": np.zeros(WORDS - 1, dtype=np.uint8)},
        {"kinds": np.zeros(WORDS, dtype=np.uint16)},
        {"kinds": np.full(WORDS, 3, dtype=np.uint8)},
        {"kinds": np.zeros(WORDS, dtype=np.uint8)},
        {"kinds": np.array([{"a": 1}], dtype=object)},
        {"skirt": np.frombuffer(b"\xff\xfe", dtype=np.uint8)},
        {"kinds": np.zeros(1 << 24, dtype=np.uint8)},
    ],
)
def test_a_file_of_another_content_is_refused_by_name(arrays: dict[str, np.ndarray], tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    _write(path, **arrays)
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path, gamma=2.2)


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04broken"])
def test_a_file_that_is_no_table_is_refused_by_name(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    path.write_bytes(content)
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path, gamma=2.2)


def test_a_missing_array_or_file_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "bad.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("other.npy", b"")
    with pytest.raises(UserError, match=r"bad\.npz cannot be used"):
        load_colour_table(path, gamma=2.2)
    with pytest.raises(UserError, match=r"gone\.npz cannot be used"):
        load_colour_table(tmp_path / "gone.npz", gamma=2.2)
