"""A robot's checkpoint: replaced in one step, read with suspicion."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from robot_agent.checkpoint import Checkpoint
from swarm.errors import UserError


def test_the_first_start_finds_nothing(tmp_path: Path) -> None:
    assert Checkpoint(tmp_path / "new", "r1", "run a").load() is None


def test_what_was_saved_comes_back_and_the_newest_wins(tmp_path: Path) -> None:
    checkpoint = Checkpoint(tmp_path / "new", "r1", "run a")
    for state in (3, 4):
        checkpoint.save({"state": state, "policy": {"q": [0.1 + 0.2, 1e-300]}})
    saved = Checkpoint(tmp_path / "new", "r1", "run a").load()
    assert saved is not None
    assert saved["state"] == 4
    assert saved["policy"]["q"] == [0.1 + 0.2, 1e-300], "floats survive to the last bit"
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["r1.json"]


def test_a_half_written_file_beside_it_does_no_harm(tmp_path: Path) -> None:
    checkpoint = Checkpoint(tmp_path, "r1", "run a")
    checkpoint.save({"state": 3})
    (tmp_path / "r1.part").write_text('{"version": 1, "sta')
    saved = checkpoint.load()
    assert saved is not None
    assert saved["state"] == 3


@pytest.mark.parametrize("content", ["", "{", "[1]", '{"version": 99}', "\x00\xff", "null"])
def test_a_damaged_file_is_refused_by_name(tmp_path: Path, content: str) -> None:
    (tmp_path / "r1.json").write_text(content)
    with pytest.raises(UserError, match=r"r1\.json: not a checkpoint.*move it away to start anew"):
        Checkpoint(tmp_path, "r1", "run a").load()
    assert (tmp_path / "r1.json").read_text() == content


def test_another_run_s_learning_is_not_gone_on_from(tmp_path: Path) -> None:
    Checkpoint(tmp_path, "r1", "run a").save({"state": 3})
    with pytest.raises(UserError, match="run a, not of run b"):
        Checkpoint(tmp_path, "r1", "run b").load()
    assert json.loads((tmp_path / "r1.json").read_text())["state"] == 3
