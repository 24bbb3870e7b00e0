"""What of a board's clock comes into the log; chronyc is a script that says what the real one said."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.messages import topics
from swarm.runtime.clock_report import report_clock
from tests.support.local_node import LocalNode
from tests.swarm.services.test_chrony import FOLLOWING


def test_every_robot_of_a_board_tells_its_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "chronyc").write_text(f"#!/bin/sh\nprintf '%s' '{FOLLOWING}'\n")
    (tmp_path / "chronyc").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    node = LocalNode()
    report_clock(node, topics.EVENT, ["r1", "r2"])
    assert [key for key, _ in node.published] == ["robot/r1/event", "robot/r2/event"]
    assert {event.text for _, event in node.published} == {"0.003 ms fast of 10.79.0.1, to 0.1 ms"}


def test_a_board_without_chrony_tells_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    node = LocalNode()
    report_clock(node, topics.EVENT, ["r1"])
    assert node.published == []
