"""A live run on the console's page: every control has its effect, in the run and in its log."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from swarm.console.sources import logs_of_trial
from tests.support.console_logs import history_of
from tests.support.console_page import ConsolePage
from tests.support.laboratory import Laboratory
from tests.support.swarm_runs import messages

Frame = dict[str, Any]


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def laboratory(tmp_path: Path, stack: ExitStack) -> Laboratory:
    return Laboratory(tmp_path, stack)


def is_in(phase: str) -> Callable[[Frame], bool]:
    return lambda frame: frame["phase"] == phase


def moved_beyond(moves: int) -> Callable[[Frame], bool]:
    return lambda frame: frame["robots"]["r0"]["moves"] > moves


def test_every_control_has_its_effect(laboratory: Laboratory, stack: ExitStack) -> None:
    page = ConsolePage(stack, "--connect", laboratory.endpoint, "--steer")
    assert "waiting" in page.told("state")["source"], "a console may be there before the run"
    server = laboratory.serve()
    waiting = page.told("state", lambda state: state["controls"] is not None)
    assert waiting["may_steer"]
    laboratory.track()
    laboratory.agent("r0")
    moves = page.told("frame", moved_beyond(2))["robots"]["r0"]["moves"]
    assert page.orders("pause", "r0")["accepted"]
    page.told("state", lambda state: state["controls"] and state["controls"]["paused"] == ["r0"])
    assert page.orders("resume", "r0")["accepted"]
    assert page.orders("pause")["accepted"]
    page.told("frame", is_in("paused"))
    refused = page.orders("pause")
    assert (refused["accepted"], refused["text"]) == (False, "the run is paused already")
    assert page.orders("resume")["accepted"]
    moves = page.told("frame", moved_beyond(moves + 2))["robots"]["r0"]["moves"]
    assert page.orders("estop")["accepted"]
    page.told("frame", is_in("estopped"))
    assert not page.orders("resume")["accepted"]
    assert page.orders("release")["accepted"]
    assert page.orders("resume")["accepted"]
    moves = page.told("frame", moved_beyond(moves + 2))["robots"]["r0"]["moves"]
    assert not page.orders("done", prompt=7)["accepted"]
    assert page.orders("stop")["accepted"]
    page.asks(ask="live")
    page.told("frame", is_in("ended"))
    server.communicate()
    assert server.returncode == 0
    run = laboratory.directory / "run"
    said = [event.text for _, event in messages(run / "trial-000.mcap", "event") if event.name == "order"]
    orders = [text.partition(" by ")[0] for text in said]
    assert orders == ["pause r0", "resume r0", "pause", "resume", "estop", "release", "resume", "stop"]
    assert all("(from the console's page)" in text for text in said)
    recorded = history_of(*logs_of_trial(run, None)).robots["r0"].learning
    assert recorded.last_number >= moves
    page.asks(ask="move", robot="r0", number=3)
    back = page.told("frame", is_in("running"))["robots"]["r0"]["moves"]
    assert 3 <= back < moves, "a move into a wall takes no time: some are told in one moment"


@pytest.mark.long
def test_a_page_survives_its_run_s_server(laboratory: Laboratory, stack: ExitStack) -> None:
    """The server is killed and goes on; what was heard before is still there."""
    server = laboratory.serve()
    laboratory.track()
    laboratory.agent("r0")
    page = ConsolePage(stack, "--connect", laboratory.endpoint)
    before = page.told("frame", moved_beyond(2))
    server.kill()
    server.wait()
    page.told("state", lambda state: "gone" in state["source"] or "waiting" in state["source"])
    laboratory.serve("--resume", laboratory.directory / "run")
    page.told("state", lambda state: state["source"].startswith("connected"))
    after = page.told("frame", moved_beyond(before["robots"]["r0"]["moves"] + 3))
    assert after["t_s"] > before["t_s"]
    page.asks(ask="move", robot="r0", number=2)
    back = page.told("frame", lambda frame: frame["jumped"])["robots"]["r0"]["moves"]
    assert 2 <= back <= before["robots"]["r0"]["moves"]


@pytest.mark.long
def test_a_log_that_is_being_written_is_followed(laboratory: Laboratory, stack: ExitStack) -> None:
    server = laboratory.serve()
    laboratory.track()
    laboratory.agent("r0")
    laboratory.wait_for_moves("r0", 3)
    page = ConsolePage(stack, laboratory.directory / "run", "--steer")
    moves = page.told("frame", moved_beyond(2))["robots"]["r0"]["moves"]
    page.told("frame", moved_beyond(moves + 2))
    page.asks(ask="move", robot="r0", number=1)
    assert page.told("learner", lambda learner: learner["moves"] < moves)["first"] == 1
    page.asks(ask="live")
    assert page.orders("stop")["accepted"]
    server.communicate()
    page.asks(ask="live")
    assert page.told("frame", is_in("ended"))
    page.told("state", lambda state: state["source"] == "the whole log is read")
