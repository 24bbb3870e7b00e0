"""The verbs of the overhead camera and of the hats, as a person calls them."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import cv2
import pytest

from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import Setup
from tracker_bridge.backends.overhead import SYSTEM
from tracker_bridge.main import call

TAGS = Path(__file__).parents[1] / "data" / "tags"
FRAME_NS = 100_000_000


def printed(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    call([str(word) for word in words])
    return capsys.readouterr().out


def test_detect_prints_ids_and_corners(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawn = tmp_path / "drawn.png"
    text = printed(capsys, "detect", TAGS / "test_image.png", "--tags", "36h11", "--json", "--out", drawn)
    tags = json.loads(text)["tags"]
    assert [tag["id"] for tag in tags] == [60, 82, 318, 328, 387]
    assert all(len(tag["corners"]) == 4 and len(tag["corners"][0]) == 2 for tag in tags)
    picture = cv2.imread(str(drawn))
    assert picture is not None
    assert picture.shape == (480, 640, 3)
    only = printed(capsys, "detect", TAGS / "test_image.png", "--tags", "36h11", "--ids", 82)
    assert only.startswith("tag 82 at (")


def test_detect_refuses_what_it_cannot_read() -> None:
    with pytest.raises(UserError, match=r"nothing\.png: there is no such file"):
        call(["detect", "nothing.png", "--tags", "36h11"])


def test_hats_are_designed_checked_and_drawn(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    hats, drawing = tmp_path / "hats.toml", tmp_path / "hats.svg"
    hats.write_text(printed(capsys, "hats", "generate", "--count", 12))
    assert json.loads(printed(capsys, "hats", "check", hats, "--json"))["findings"] == []
    assert "hats r1 and r" in printed(capsys, "hats", "check", hats, "--tolerance-mm", 20)
    call(["hats", "sheet", str(hats), "--out", str(drawing)])
    groups = ElementTree.parse(drawing).getroot().findall("{http://www.w3.org/2000/svg}g")
    assert len(groups) == 12
    with pytest.raises(UserError, match="nothing is overwritten"):
        call(["hats", "sheet", str(hats), "--out", str(drawing)])


def test_a_hat_file_with_a_mistake_is_refused_by_line(tmp_path: Path) -> None:
    hats = tmp_path / "hats.toml"
    hats.write_text('[[hat]]\nname = "a"\npins_mm = [[1, 2]]\n[[hat]]\nname = "a"\npins_mm = [[1, 2]]\n')
    with pytest.raises(UserError, match=r"hats\.toml:5: two hats are named 'a'"):
        call(["hats", "check", str(hats)])


def test_a_rehearsal_from_pictures_to_poses(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Emulate, place the camera by the floor's tags, and track: the poses are the truth's."""
    folder, placed = tmp_path / "lab", tmp_path / "lab" / "placed.toml"
    swarm = ("--robots", 3, "--seconds", 0.3, "--frames-per-s", 10)
    printed(capsys, "emulate", "camera", "--out", folder, "--boards", 0, *swarm)
    settings, lens = folder / "overhead.toml", folder / "camera.toml"
    text = printed(
        capsys, "calibrate", "camera", "place", folder / "floor.png",
        "--settings", settings, "--lens", lens, "--out", placed,
    )  # fmt: skip
    assert text.startswith("the camera is at (1.5")
    settings.write_text(settings.read_text().replace("camera.toml", "placed.toml"))
    setup = Setup(tracked_experiment(TrackerSettings(backend="overhead", file=str(settings))), None)
    with SYSTEM.open(setup) as backend:
        seen = {number: backend.poses(number * FRAME_NS * 3) for number in range(3)}
    poses = [tracked for given in seen.values() for tracked in given]
    with (folder / "truth.csv").open() as file:
        truth = {(int(row["frame"]), row["robot"]): row for row in csv.DictReader(file)}
    assert {tracked.robot for tracked in poses} == {"r1", "r2", "r3"}
    for tracked in poses:
        row = truth[
            0 if tracked.captured_t_ns == 0 else round(tracked.captured_t_ns * 30 / 1e9), tracked.robot
        ]
        assert tracked.pose.x_m == pytest.approx(float(row["x_m"]), abs=0.003)
        assert tracked.pose.y_m == pytest.approx(float(row["y_m"]), abs=0.003)
