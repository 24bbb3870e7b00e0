"""Recordings as the systems write them: byte-order mark, CRLF, blank cells, units, rotation vectors."""

from __future__ import annotations

import gzip
import math
import random
from contextlib import suppress
from pathlib import Path

import pytest

from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from tests.conftest import SmallRun
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.replay import replay

VICON = (
    "\ufeffObjects\r\n100\r\n"
    ",,Global Angle r1:r1,,,,,,r2:r2,,,,,\r\n"
    "Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\r\n"
    ",,rad,rad,rad,mm,mm,mm,rad,rad,rad,mm,mm,mm\r\n"
    "1,0,0,0,1.5,1000.5,500,80,0,0,6.0,2000,1500,80\r\n"
    "2,0,0,0,1.5,1001.5,500,80,,,,,,\r\n"
    "3,0,0,0,0,0,0,0,0,0,6.0,2001,1500,80\r\n"
)
MOTIVE = (
    "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120.000000,Rotation Type,Quaternion,"
    "Length Units,Millimeters,Coordinate Space,Global\n"
    "\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,"
    "Rigid Body Marker,Rigid Body Marker,Rigid Body Marker\n"
    ",Name,r1,r1,r1,r1,r1,r1,r1,r1,r1:Marker1,r1:Marker1,r1:Marker1\n"
    ",ID,1,1,1,1,1,1,1,1,2,2,2\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,"
    "Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z\n"
    "0,0.000000,0,0.70710678,0,0.70710678,1000,80,-500,0.4,1,2,3\n"
    "1,0.008333,,,,,,,,,,,\n"
    "2,0.016667,0,0.70710678,0,0.70710678,1001,80,-500,0.5,1,2,3\n"
)
QUALISYS = (
    "NO_OF_FRAMES\t2\nNO_OF_CAMERAS\t8\nNO_OF_BODIES\t2\nFREQUENCY\t200\nDATA_INCLUDED\t6D\n"
    "BODY_NAMES\tr1\tr2\n"
    "Frame\tTime\t"
    + "\t".join(
        f"{name} X\tY\tZ\tRoll\tPitch\tYaw\tResidual\t" + "\t".join(f"Rot[{each}]" for each in range(9))
        for name in ("r1", "r2")
    )
    + "\n"
    "1\t0.0\t1000\t500\t80\t0\t0\t90\t0.3\t0\t1\t0\t-1\t0\t0\t0\t0\t1"
    "\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\n"
    "2\t0.005\t1001\t500\t80\t0\t0\t90\t0.3\t0\t1\t0\t-1\t0\t0\t0\t0\t1"
    "\t2000\t1500\t80\t0\t0\t0\t0.4\t-1\t0\t0\t0\t-1\t0\t0\t0\t1\n"
)
ARTCULT = "".join(
    f"12,{1276102516.053952 + 0.06 * row:.6f},{9652 + 30 * row},9595,2574,3\n" for row in range(13)
)
"""The first line is the laboratory's; the others go on as its log does, 0.06 s and some 30 units apart."""


def played(
    directory: Path, text: str, axes: str = "x y z", bodies: tuple[str, ...] = ()
) -> list[TrackedPose]:
    """Everything in a recording, the first moment being second 1."""
    file = directory / "recording.csv"
    file.write_bytes(text.encode("utf-8"))
    player = replay(tracked_experiment(TrackerSettings(axes=axes), ("r1", "r2"), bodies), file)
    poses = player.poses(10**9) + player.poses(10**12)
    assert player.is_over
    return poses


def rounded(poses: list[TrackedPose]) -> list[tuple[str, float, float, float, int]]:
    return [
        (
            tracked.robot,
            round(tracked.pose.x_m, 4),
            round(tracked.pose.y_m, 4),
            round(tracked.pose.theta_rad, 4),
            round((tracked.captured_t_ns - 10**9) / 1e6),
        )
        for tracked in poses
    ]


def test_vicon_tracker_3(tmp_path: Path) -> None:
    """A lost object is blank or zero; a rotation vector of 6 rad turns the other way by 0.28."""
    assert rounded(played(tmp_path, VICON)) == [
        ("r1", 1.0005, 0.5, 1.5, 0),
        ("r2", 2.0, 1.5, round(6.0 - math.tau, 4), 0),
        ("r1", 1.0015, 0.5, 1.5, 10),
        ("r2", 2.001, 1.5, round(6.0 - math.tau, 4), 20),
    ]


def test_vicon_in_degrees(tmp_path: Path) -> None:
    text = VICON.replace("rad,rad,rad", "deg,deg,deg").replace("0,0,1.5,", "0,0,90,")
    assert rounded(played(tmp_path, text))[0] == ("r1", 1.0005, 0.5, round(math.pi / 2, 4), 0)


def test_motive(tmp_path: Path) -> None:
    poses = played(tmp_path, MOTIVE, axes="x -z y")
    north = round(math.pi / 2, 4)
    assert rounded(poses) == [("r1", 1.0, 0.5, north, 0), ("r1", 1.001, 0.5, north, 17)]
    assert [tracked.residual_m for tracked in poses] == pytest.approx([0.0004, 0.0005])


def test_motive_with_angles_says_how_to_export(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="export them as Quaternion"):
        played(tmp_path, MOTIVE.replace("Quaternion", "XYZ"))


def test_qualisys(tmp_path: Path) -> None:
    north, west = round(math.pi / 2, 4), round(math.pi, 4)
    poses = played(tmp_path, QUALISYS)
    assert rounded(poses) == [
        ("r1", 1.0, 0.5, north, 0),
        ("r1", 1.001, 0.5, north, 5),
        ("r2", 2.0, 1.5, west, 5),
    ]
    assert [tracked.residual_m for tracked in poses] == pytest.approx([0.0003, 0.0003, 0.0004])


def test_the_first_laboratorys_log(tmp_path: Path) -> None:
    """In the unit that its page gives, robots would drive 0.5 m/s."""
    poses = played(tmp_path, ARTCULT, bodies=("12", "13"))
    assert poses[0].robot == "r1"
    first, last = poses[0], poses[-1]
    elapsed_s = (last.captured_t_ns - first.captured_t_ns) / 1e9
    assert first.pose.distance_m(last.pose) / elapsed_s == pytest.approx(0.05, abs=0.001)
    assert first.height_m == pytest.approx(0.2574)


def test_points_face_where_they_drive(tmp_path: Path) -> None:
    rows = [f"{number},2024-10-31T16:26:05.{5 + number:03d}000Z,{10 * number},50\n" for number in range(9)]
    text = ",timestamp,r1_x,r1_y,r1_z\n" + "".join(row.rstrip() + ",0\n" for row in rows)
    poses = played(tmp_path, text)
    assert [round(tracked.pose.x_m, 3) for tracked in poses] == [0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08]
    assert {tracked.pose.theta_rad for tracked in poses} == {0.0}


def test_a_recording_may_be_packed(tmp_path: Path) -> None:
    file = tmp_path / "recording.csv.gz"
    file.write_bytes(gzip.compress(VICON.encode()))
    assert len(replay(tracked_experiment(TrackerSettings(), ("r1",)), file).poses(0)) == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no recording that is known"),
        ("a,b,c\n", "no recording that is known"),
        (VICON.replace("mm,mm,mm", "ft,ft,ft"), "not a sound Vicon Tracker CSV"),
        (VICON.replace("1000.5", "1e3e"), "not a sound Vicon Tracker CSV"),
        (VICON[: VICON.index("1,0,0")], "nobody was seen"),
        (MOTIVE[: MOTIVE.index("Frame,Time")], "not a sound Motive CSV"),
        (MOTIVE.replace(",Type,", ",Kind,"), "not a sound Motive CSV"),
        (QUALISYS.replace("FREQUENCY", "RATE"), "not a sound Qualisys TSV"),
        (ARTCULT.replace("1276102516.113952", "1e99999999"), "not a sound artificial culture log"),
    ],
)
def test_a_file_that_is_damaged_is_named(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        played(tmp_path, text)


@pytest.mark.parametrize(
    "text", [VICON, MOTIVE, QUALISYS, ARTCULT], ids=["vicon", "motive", "qtm", "artcult"]
)
def test_damage_anywhere_is_an_error_or_costs_only_its_place(tmp_path: Path, text: str) -> None:
    rng, file = random.Random(5), tmp_path / "damaged.csv"
    experiment, whole = tracked_experiment(TrackerSettings(), ("r1", "r2")), 0
    for _ in range(300):
        at = rng.randrange(len(text))
        noise = "".join(rng.choices('0.,-e"\t\n\x00\x7f9infa', k=rng.randrange(4)))
        file.write_text(text[:at] + noise + text[at + rng.randrange(9) :], encoding="utf-8")
        with suppress(UserError):
            replay(experiment, file).poses(0)
            whole += 1
    assert whole > 30


def test_a_log_of_ours_plays_the_poses_it_holds(small_run: SmallRun) -> None:
    player = replay(tracked_experiment(TrackerSettings(), ("expert",)), small_run.log)
    poses = player.poses(5 * 10**9) + player.poses(10**13)
    assert {tracked.robot for tracked in poses} == {"expert", "imitator", "loner"}
    assert len(poses) > 500
    assert poses[0].captured_t_ns == 5 * 10**9
    times = [tracked.captured_t_ns for tracked in poses]
    assert times == sorted(times)
