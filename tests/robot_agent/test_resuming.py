"""What an agent goes on from: a checkpoint that anybody could have changed, on a disk that may be full."""

from __future__ import annotations

import json
import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robot_agent.checkpoint import Checkpoint
from swarm.errors import UserError
from tests.robot_agent.test_agent import Rig, of

RUN = ("0123456789ab", "fingerprint")
"""The run's id and identity."""


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The file of a robot that has made some moves."""
    directory = tmp_path_factory.mktemp("saved")
    rig = Rig(directory)
    rig.agent.resume_from(Checkpoint(directory, "r0", *RUN))
    rig.run(60)
    return (directory / "r0.json").read_text()


def resumed(directory: Path, text: str) -> Rig:
    (directory / "r0.json").write_text(text)
    rig = Rig(directory)
    rig.agent.resume_from(Checkpoint(directory, "r0", *RUN))
    return rig


def test_what_was_saved_is_gone_on_from(tmp_path: Path, saved: str) -> None:
    moves = of(resumed(tmp_path, saved).run(30), "move")
    assert moves[0].number == json.loads(saved)["policy"]["moves"] + 1


BAD_VALUES: tuple[Any, ...] = (
    *(-1, 5000, 10**30, float("nan"), float("inf")),
    *(None, "x", [], {}, [[]], True),
)


@pytest.mark.parametrize("state", [5000, -1, 100, 1.5, "7", None, True, [3]])
def test_a_cell_that_is_none_is_refused(tmp_path: Path, saved: str, state: object) -> None:
    with pytest.raises(UserError, match=r"r0\.json: does not fit this experiment"):
        resumed(tmp_path, json.dumps({**json.loads(saved), "state": state}))


def places(part: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where every value stands; of a long list the first entry only."""
    yield place
    entries = (
        part.items() if isinstance(part, dict) else enumerate(part[:1]) if isinstance(part, list) else ()
    )
    for name, value in entries:
        yield from places(value, (*place, name))


def test_no_changed_value_leads_to_anything_but_a_refusal_or_a_robot_that_works(
    tmp_path: Path, saved: str
) -> None:
    """Every value in turn, by each of these."""
    refused, tried = 0, 0
    for place in places(json.loads(saved)["policy"]):
        for value in BAD_VALUES:
            content = json.loads(saved)
            part = content
            for name in ("policy", *place[:-1]):
                part = part[name]
            part[place[-1] if place else "policy"] = value
            tried += 1
            try:
                rig = resumed(tmp_path, json.dumps(content))
            except UserError:
                refused += 1
            else:
                rig.run(5)
    assert refused > 0.8 * tried > 150


def test_a_deeply_nested_checkpoint_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"r0\.json: not a checkpoint"):
        resumed(tmp_path, "[" * 100_000)


def test_a_robot_whose_disk_is_full_goes_on_and_says_so_once(tmp_path: Path) -> None:
    rig = Rig(tmp_path)
    rig.agent.resume_from(Checkpoint(tmp_path, "r0", *RUN))
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
    try:
        published = rig.run(60)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    assert len(of(published, "move")) > 10
    (event,) = of(published, "event")
    assert event.text.startswith("what is learnt is not saved: ")
    rig.run(30)
    assert json.loads((tmp_path / "r0.json").read_text())["policy"]["moves"] > 10
