"""What is looked at before anything starts: each way in which an experiment or a machine can be unfit."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robot_agent.checks import robot_checks
from swarm.checkup.checkup import experiment_findings, findings
from swarm.checkup.finding import Level, require_good
from swarm.checkup.machine import LONGEST_SOCKET_PATH, room, temporary_place, writable
from swarm.cli.app import app
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.plugins import CHECKS, DRIVERS, TRACKERS, plugins
from tests.support.swarm_runs import ROOT, write_experiment

TWO = """[run]
name = "two"
moves = 20

[[robot]]
id = "a"
south_west_m = [0.15, 0.3]
{of_a}

[[robot]]
id = "b"
south_west_m = [1.65, 0.3]

{tables}
"""


def two_robots(directory: Path, of_a: str = "", tables: str = "") -> Path:
    return write_experiment(directory, TWO.format(of_a=of_a, tables=tables))


def refusal(file: Path) -> str:
    """What is said about an experiment that must not start."""
    with pytest.raises(UserError) as refused:
        require_good(file, experiment_findings(Experiment.load(file)))
    return str(refused.value).removeprefix(f"{file}:")


def test_the_demo_can_start_on_this_machine(tmp_path: Path) -> None:
    experiment = Experiment.load(ROOT / "deploy" / "sim" / "demo.toml")
    found = findings(experiment, tmp_path / "run")
    assert {finding.level for finding in found} == {Level.GOOD}
    about = [finding.about for finding in found]
    assert {"driver of imitator", "skirt of expert", "camera's light", "tracker", "disk"} <= set(about)
    assert not (tmp_path / "run").exists(), "looking writes nothing"


@pytest.mark.parametrize("watches", ["", 'watches = "b"'], ids=["nobody watches", "one watches"])
@pytest.mark.parametrize(
    ("of_a", "tables", "said"),
    [
        ('driver = "simm"', "", "there is no driver 'simm'; did you mean 'sim'?"),
        ("keep_off_m = 0.02", "", "needs proximity sensors, which a simulated robot has not"),
        ('skirt = "banana"', "", "unknown colour 'banana'; known: black, blue, "),
        ("", '[tracker]\nbackend = "simm"', "there is no tracking system 'simm'; did you mean 'sim'?"),
        ("", '[tracker]\nfile = "nope.csv"', "nope.csv: there is no such file"),
        ("", '[tracker]\naxes = "x y q"', "'x y q' does not name three axes"),
        ("", '[camera]\nconditions = "sunny"', "unknown camera conditions 'sunny'; known: clean, dark"),
        ("", '[camera]\ncalibration = "nope.toml"', "nope.toml: there is no such file"),
        ("", '[camera]\ncolours = "nope.npz"', "colour table nope.npz cannot be used"),
    ],
    ids=["driver", "reflex", "skirt", "tracker", "file", "axes", "conditions", "calibration", "colours"],
)
def test_names_and_files_are_looked_up_whoever_watches(
    tmp_path: Path, watches: str, of_a: str, tables: str, said: str
) -> None:
    file = two_robots(tmp_path, f"{of_a}\n{watches}", tables)
    line, _, text = refusal(file).partition(": ")
    assert said in text
    key = (of_a or tables).splitlines()[-1]
    assert file.read_text().splitlines()[int(line) - 1] == key


def test_a_robot_on_a_board_is_not_refused_for_another_s_driver(tmp_path: Path) -> None:
    experiment = Experiment.load(two_robots(tmp_path, 'driver = "lego"'))
    other = experiment.robot_named("b")
    assert {finding.level for finding in robot_checks(experiment, (other,))} == {Level.GOOD}


def test_an_observer_s_place_off_the_floor_is_refused_at_once(tmp_path: Path) -> None:
    file = two_robots(tmp_path, 'watches = "b"')
    file.write_text(file.read_text().replace("[1.65, 0.3]", "[1.65, 0.0]"))
    with pytest.raises(UserError, match=r":12: 'a' would watch 'b' from \(2.90, -0.05\) m, which is off"):
        Experiment.load(file)


def test_a_long_place_for_temporary_files_is_blamed_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    for length, level in ((88, Level.GOOD), (89, Level.BAD)):
        place = "/" + "x" * (length - 1)
        assert len(f"{place}/swarm-12345678/hub") <= LONGEST_SOCKET_PATH or level is Level.BAD
        monkeypatch.setattr(tempfile, "tempdir", place)
        assert temporary_place().level is level
    assert "set TMPDIR to a short path" in temporary_place().cure


@pytest.mark.parametrize("out", ["/proc/run", "/dev/null/run", "/"])
def test_a_place_that_cannot_be_written_to_is_named(tmp_path: Path, out: str) -> None:
    experiment = Experiment.load(two_robots(tmp_path))
    last = list(room(experiment, Path(out)))[-1]
    assert last.level is Level.BAD
    assert "choose another --out" in last.cure


def test_state_is_tried_before_the_robot_starts(tmp_path: Path) -> None:
    assert writable("--state", tmp_path / "new" / "state").level is Level.GOOD
    assert not (tmp_path / "new").exists()
    (tmp_path / "file").write_bytes(b"")
    assert writable("--state", tmp_path / "file").level is Level.BAD
    assert writable("--state", Path("/proc/state")).level is Level.BAD


def test_logs_that_may_not_fit_are_told_of(tmp_path: Path) -> None:
    file = two_robots(tmp_path)
    file.write_text(file.read_text().replace("moves = 20", "moves = 10_000_000\ntrials = 10_000"))
    disk = list(room(Experiment.load(file), tmp_path / "run"))[-1]
    assert (disk.about, disk.level) == ("disk", Level.WARNING)
    assert "the logs may need 1,200,000,000 MB" in disk.text


def test_the_doctor_prints_what_it_found_and_the_cure(tmp_path: Path) -> None:
    good, bad = two_robots(tmp_path / "good"), two_robots(tmp_path / "bad", 'driver = "simm"')
    for file, code in ((good, 0), (bad, 1)):
        place = ["--out", str(tmp_path / "run")]
        shown = CliRunner().invoke(app, ["doctor", str(file), *place])
        told = CliRunner().invoke(app, ["doctor", str(file), "--json", *place])
        assert (shown.exit_code, told.exit_code) == (code, code), shown.output
        levels = [finding["level"] for finding in json.loads(told.output)["findings"]]
        assert ("bad" in levels) == ("did you mean 'sim'?" in shown.output) == bool(code)
    assert not (tmp_path / "run").exists()


def test_everything_that_can_be_named_can_be_loaded() -> None:
    for group in (DRIVERS, TRACKERS, CHECKS):
        assert all(callable(entry.load()) or group == TRACKERS for entry in plugins(group).values())
