"""A robot's checkpoint: replaced in one step, read with suspicion, and of one run."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import pytest

from robot_agent.checkpoint import Checkpoint, OtherRun
from swarm.errors import UserError

of_run_a = partial(Checkpoint, robot="r1", run_id="aaa", identity="x")
of_run_b = partial(Checkpoint, robot="r1", run_id="bbb", identity="x")


def test_the_first_start_finds_nothing(tmp_path: Path) -> None:
    for other in OtherRun:
        assert of_run_a(tmp_path / "new", other=other).load() is None


def test_what_was_saved_comes_back_and_the_newest_wins(tmp_path: Path) -> None:
    checkpoint = of_run_a(tmp_path / "new")
    for state in (3, 4):
        checkpoint.save(state, {"q": [0.1 + 0.2, 1e-300]})
    saved = of_run_a(tmp_path / "new").load()
    assert saved is not None
    assert saved.same_run
    assert saved.state == 4
    assert saved.policy["q"] == [0.1 + 0.2, 1e-300], "floats survive to the last bit"
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["r1.json"]


def test_a_half_written_file_beside_it_does_no_harm(tmp_path: Path) -> None:
    checkpoint = of_run_a(tmp_path)
    checkpoint.save(3, {})
    (tmp_path / "r1.part").write_text('{"version": 1, "sta')
    saved = checkpoint.load()
    assert saved is not None
    assert saved.state == 3


DAMAGED = ["", "{", "[1]", '{"version": 99}', '{"version": 3}', "\x00\xff", "null", "[" * 100_000]


@pytest.mark.parametrize("content", DAMAGED)
@pytest.mark.parametrize("other", [OtherRun.REFUSED, OtherRun.RESUMED])
def test_a_damaged_file_is_refused_by_name(tmp_path: Path, content: str, other: OtherRun) -> None:
    (tmp_path / "r1.json").write_text(content)
    with pytest.raises(UserError, match=r"r1\.json: not a checkpoint.*--fresh begins anew"):
        of_run_a(tmp_path, other=other).load()
    assert (tmp_path / "r1.json").read_text() == content


def test_another_run_s_learning_is_refused_with_the_cure(tmp_path: Path) -> None:
    of_run_a(tmp_path).save(3, {"moves": 20})
    with pytest.raises(UserError, match=r"run aaa \(20 moves\), and this is run bbb: --fresh .* --resume"):
        of_run_b(tmp_path).load()
    assert json.loads((tmp_path / "r1.json").read_text())["state"] == 3


def test_the_same_run_id_with_another_identity_is_another_run(tmp_path: Path) -> None:
    of_run_a(tmp_path).save(3, {})
    with pytest.raises(UserError, match="--fresh"):
        Checkpoint(tmp_path, "r1", "aaa", "y").load()


def test_resume_takes_what_another_run_learnt_and_says_of_which(tmp_path: Path) -> None:
    of_run_a(tmp_path).save(3, {"moves": 20})
    saved = of_run_b(tmp_path, other=OtherRun.RESUMED).load()
    assert saved is not None
    assert (saved.same_run, saved.run_id, saved.moves) == (False, "aaa", 20)


def test_fresh_begins_anew_and_keeps_every_old_file(tmp_path: Path) -> None:
    for state in (3, 4):
        of_run_a(tmp_path).save(state, {})
        assert of_run_b(tmp_path, other=OtherRun.FRESH).load() is None
    kept = {path.name: json.loads(path.read_text())["state"] for path in tmp_path.iterdir()}
    assert kept == {"r1.aaa.json": 3, "r1.aaa-2.json": 4}


def test_fresh_sets_a_damaged_file_aside_and_never_what_this_run_learnt(tmp_path: Path) -> None:
    (tmp_path / "r1.json").write_text("{")
    fresh = of_run_a(tmp_path, other=OtherRun.FRESH)
    assert fresh.load() is None
    assert (tmp_path / "r1.damaged.json").read_text() == "{"
    fresh.save(5, {})
    saved = fresh.load()
    assert saved is not None
    assert saved.state == 5
