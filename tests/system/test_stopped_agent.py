"""An agent that hangs while its simulated robot drives: the robot stood meanwhile, as real wheels do."""

from __future__ import annotations

import itertools
import math
import os
import signal
import threading
from pathlib import Path

import pytest

from swarm.messages import topics
from tests.support.stop_errors import records
from tests.support.swarm_runs import experiment_text, learners, write_experiment
from tests.support.watched_server import WatchedServer

FURTHEST_M = 0.04
STOPPED_S = 1.0
DRIVING_S = (0.9, 1.1, 1.3)
"""Times between two stops, so that they come in other moments of a move."""
GAP_NS = 800_000_000
"""Two truths of a robot lie 0.1 s apart, unless its agent was stopped in between."""


def distances_over_stops(place: Path, stops: int) -> list[float]:
    """How far the robot went (m) while its agent was stopped, each time."""
    experiment = write_experiment(place, experiment_text(learners(1), moves=1000))
    with WatchedServer(experiment, place / "run", ("--speed", "1")) as server:
        server.wait_until_under_way()
        agent = server.children["robots-0"].pid
        for _, driving_s in zip(range(stops), itertools.cycle(DRIVING_S), strict=False):
            os.kill(agent, signal.SIGSTOP)
            threading.Event().wait(STOPPED_S)
            os.kill(agent, signal.SIGCONT)
            threading.Event().wait(driving_s)
        server.process.send_signal(signal.SIGINT)
        server.finish()
    truths = records(place / "run" / "trial-000.mcap", "r0", topics.TRUTH)
    return [
        math.hypot(after.x_m - before.x_m, after.y_m - before.y_m)
        for (before_ns, before), (after_ns, after) in itertools.pairwise(truths)
        if after_ns - before_ns > GAP_NS
    ]


def assert_stood(distances_m: list[float], stops: int) -> None:
    assert len(distances_m) == stops
    assert max(distances_m) <= FURTHEST_M
    assert max(distances_m) > 0.001, "in one of these moments it was driving"


def test_a_simulated_robot_stands_while_its_agent_is_stopped(tmp_path: Path) -> None:
    assert_stood(distances_over_stops(tmp_path, 4), 4)


@pytest.mark.long
def test_it_stands_twenty_times_of_twenty(tmp_path: Path) -> None:
    distances_m = distances_over_stops(tmp_path, 20)
    print([round(distance, 4) for distance in distances_m])
    assert_stood(distances_m, 20)
