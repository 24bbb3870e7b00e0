"""How a page goes through a run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from swarm.console.run_history import RunHistory
from swarm.console.viewer import Viewer
from tests.support.console_logs import history_of
from tests.support.learnt_logs import ROBOT, learnt_log

MOVES = 120


@pytest.fixture(scope="module")
def history(tmp_path_factory: pytest.TempPathFactory) -> RunHistory:
    path: Path = tmp_path_factory.mktemp("viewed") / "trial-000.mcap"
    learnt_log(path, MOVES)
    return history_of(path)


@pytest.fixture
def viewer(history: RunHistory) -> Viewer:
    return Viewer(history, live=False)


def told(viewer: Viewer, elapsed_s: float = 0.0) -> dict[str, Any]:
    return {message["kind"]: message for message in viewer.step(elapsed_s)}


def test_a_page_is_introduced_once_and_told_only_what_is_new(viewer: Viewer) -> None:
    first = told(viewer)
    assert {"about", "growth", "frame", "learner"} <= first.keys()
    assert [move for _, move, _ in first["growth"]["curves"][ROBOT]] == list(range(10, MOVES + 1, 10))
    viewer.asked({"ask": "pause"})
    assert told(viewer, 1.0) == {}


def test_it_plays_at_its_speed_and_stands_when_paused(viewer: Viewer) -> None:
    viewer.asked({"ask": "speed", "times": 20})
    assert told(viewer, 0.5)["frame"]["t_s"] == 10.0
    viewer.asked({"ask": "pause"})
    viewer.step(5.0)
    assert viewer.cursor_s == 10.0
    viewer.asked({"ask": "play"})
    assert told(viewer, 0.5)["frame"]["t_s"] == 20.0


def test_any_move_is_found_and_a_number_beyond_is_the_last(viewer: Viewer, history: RunHistory) -> None:
    viewer.asked({"ask": "pause"})
    for number, expected in ((1, 1), (57, 57), (MOVES, MOVES), (10**9, MOVES), (-5, 1)):
        viewer.asked({"ask": "move", "robot": ROBOT, "number": number})
        shown = told(viewer)["frame"]
        assert shown["robots"][ROBOT]["moves"] == expected
        assert shown["jumped"]
    assert viewer.cursor_s <= history.end_s


def test_a_page_that_follows_shows_the_newest_moment_until_it_goes_elsewhere(history: RunHistory) -> None:
    viewer = Viewer(history, live=True)
    assert told(viewer)["frame"]["t_s"] == round(history.end_s, 3)
    viewer.asked({"ask": "seek", "t_s": 3.0})
    assert told(viewer)["frame"]["t_s"] == 3.0
    viewer.asked({"ask": "live"})
    assert told(viewer)["frame"]["t_s"] == round(history.end_s, 3)


def test_playing_on_from_the_end_begins_again(viewer: Viewer, history: RunHistory) -> None:
    viewer.asked({"ask": "seek", "t_s": history.end_s})
    viewer.asked({"ask": "play"})
    assert viewer.cursor_s == 0.0


NONSENSE: list[Callable[[], Any]] = [
    lambda: None,
    lambda: [],
    lambda: {"ask": "speed", "times": float("nan")},
    lambda: {"ask": "speed", "times": "fast"},
    lambda: {"ask": "seek", "t_s": float("inf")},
    lambda: {"ask": "seek"},
    lambda: {"ask": "select", "robot": "<script>"},
    lambda: {"ask": "move", "robot": "nobody", "number": 5},
    lambda: {"ask": "observation", "robot": "nobody", "visit": 1},
    lambda: {"ask": {"ask": "play"}},
]


@pytest.mark.parametrize("words", NONSENSE)
def test_nonsense_changes_nothing(viewer: Viewer, words: Callable[[], Any]) -> None:
    viewer.step(0.1)
    viewer.asked({"ask": "pause"})
    before = viewer.state
    viewer.asked(words())
    assert viewer.state == before
    assert told(viewer) == {}
