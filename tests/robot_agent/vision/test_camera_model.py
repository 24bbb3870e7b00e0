"""The camera's geometry, and what is said of a calibration file that cannot be used."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robot_agent.vision.camera_model import CameraModel, load_camera_model
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.support.swarm_runs import ROOT

CAMERAS = ROOT / "deploy" / "cameras"


@pytest.mark.parametrize(("name", "width"), [("epuck_320x240", 320), ("epuck_160x120", 160)])
def test_the_shipped_files_describe_one_camera_at_two_sizes(name: str, width: int) -> None:
    model = load_camera_model(CAMERAS / f"{name}.toml")
    assert model == load_camera_model(CAMERAS / "epuck_320x240.toml").scaled(width, width * 3 // 4)


def test_the_field_of_view_is_the_angle_between_the_borders_distortion_included() -> None:
    model = CameraModel(320, 240, math.radians(53), radial=(-0.15, 0.02))
    assert model.bearing_rad(-0.5) - model.bearing_rad(319.5) == pytest.approx(math.radians(53), abs=1e-9)


@pytest.mark.parametrize("bearing_deg", [-26.0, -12.5, 0.0, 3.0, 25.0])
def test_column_and_bearing_are_inverse_and_left_is_positive(bearing_deg: float) -> None:
    model = load_camera_model(CAMERAS / "epuck_320x240.toml")
    column = model.column(math.radians(bearing_deg))
    assert model.bearing_rad(column) == pytest.approx(math.radians(bearing_deg), abs=1e-12)
    assert (column < model.centre_column) == (bearing_deg > 0)


def test_without_distortion_the_lens_is_a_pinhole() -> None:
    model = CameraModel(320, 240, math.radians(53))
    right, up = model.slopes(model.centre_column + 50, model.horizon_row - 30)
    assert float(right) == pytest.approx(50 / model.focal_px)
    assert float(up) == pytest.approx(30 / model.focal_px)


def test_the_camera_sits_ahead_of_the_turning_axis() -> None:
    model = CameraModel(320, 240, 0.9, forward_m=0.03, yaw_rad=0.1)
    camera = model.pose(Pose(1.0, 2.0, math.pi / 2))
    assert camera.x_m == pytest.approx(1.0)
    assert camera.y_m == pytest.approx(2.03)
    assert camera.theta_rad == pytest.approx(math.pi / 2 + 0.1)


@pytest.mark.parametrize(
    ("line", "wrong", "said"),
    [
        ("width = 320", "widht = 320", "did you mean 'width'"),
        ("height = 240", "", "'height' is missing in [image]"),
        ("height = 240", 'height = "240"', "is a whole number, not"),
        ("height = 240", "height = 241", "even"),
        ("radial = [-0.08, 0.01]", "radial = [-0.08]", "has 1 values; it takes 2"),
        ("radial = [-0.08, 0.01]", "radial = [-5.0, 0.0]", "fold"),
        ("gamma = 2.2", "gamma = nan", "a finite number is wanted"),
        ("gamma = 2.2", "gamma = 0.0", "gamma must be"),
        ("[mounting]", "[mountings]", "did you mean 'mounting'"),
        ("[mounting]", "mounting = ", "not valid TOML"),
    ],
)
def test_a_bad_file_is_refused_by_name_and_field(line: str, wrong: str, said: str, tmp_path: Path) -> None:
    good = (CAMERAS / "epuck_320x240.toml").read_text()
    assert line in good
    path = tmp_path / "camera.toml"
    path.write_text(good.replace(line, wrong))
    with pytest.raises(UserError) as error:
        load_camera_model(path)
    assert said in str(error.value)
    assert "camera.toml" in str(error.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"nowhere\.toml"):
        load_camera_model(tmp_path / "nowhere.toml")
