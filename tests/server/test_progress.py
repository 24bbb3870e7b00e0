"""What a person sees of a run that goes on: on a terminal, and where there is none."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import Message
from rich.console import Console

from server.conductor.carrier import SimulatedCarrier
from server.conductor.conductor import Conductor
from server.progress import RunProgress, print_summary, span, times
from server.reporter import Reporter
from swarm.config.experiment import Experiment
from swarm.messages.topics import Topic
from swarm.runtime.identity import RunIdentity
from tests.support.controls import control_of
from tests.support.swarm_runs import experiment_text, write_experiment


class Run:
    """A run whose robots have made so many moves, and a clock that the test sets."""

    def __init__(self, directory: Path, *, terminal: bool) -> None:
        text = experiment_text(moves=500).replace("moves = 500", "moves = 500\ntrials = 4")
        experiment = Experiment.load(write_experiment(directory, text))
        self.now_s = 100.0
        self._shown = io.StringIO()
        console = Console(file=self._shown, force_terminal=terminal, width=120)
        self.progress = RunProgress(experiment, console, lambda: self.now_s)
        reporter = Reporter(self)
        identity, carrier = RunIdentity.of(experiment, 2), SimulatedCarrier(reporter)
        control = control_of(experiment, reporter)
        self.conductor = Conductor(experiment, identity, reporter, carrier, control)

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        """A conductor says something; nobody listens."""

    def show(self, elapsed_s: float) -> str:
        """What has been shown by then."""
        self.conductor.moves.update(expert=900, imitator=335, loner=300)
        self.conductor.best_path["loner"] = 14
        self.progress.show(self.conductor, elapsed_s)
        return self._shown.getvalue()


def test_without_a_terminal_a_line_comes_every_30_s(tmp_path: Path) -> None:
    run = Run(tmp_path, terminal=False)
    with run.progress:
        run.progress.begin(2)
        shown = []
        for now_s in (129.0, 130.0, 159.0, 160.0):
            run.now_s = now_s
            shown.append(run.show(elapsed_s=5400.0).splitlines())
    assert [len(lines) for lines in shown] == [0, 1, 1, 2]
    assert shown[1] == ["trial-002 of 4: 300/500 moves, 1.5 h, path: learner 14"]


def test_the_bar_counts_what_the_trial_waits_for(tmp_path: Path) -> None:
    """The slowest learner's moves, not the sum; the trial by the name of its log; hours since it began."""
    run = Run(tmp_path, terminal=True)
    with run.progress:
        run.progress.begin(2)
        run.show(elapsed_s=5400.0)
    shown = run.show(elapsed_s=5400.0)
    assert "trial-002 of 4" in shown
    assert "300/500 moves" in shown
    assert "1.5 h, path: learner 14" in shown


@pytest.mark.parametrize(
    ("factor", "said"), [(213.4, "213"), (10.0, "10"), (1.004, "1"), (0.36, "0.36"), (0.0, "0")]
)
def test_a_laboratory_s_speed_is_not_0(factor: float, said: str) -> None:
    assert times(factor) == said


@pytest.mark.parametrize(
    ("seconds", "said"), [(16.2, "16 s"), (119.0, "119 s"), (754.0, "13 min"), (5400.0, "1.5 h")]
)
def test_a_short_run_does_not_take_0_h(seconds: float, said: str) -> None:
    assert span(seconds) == said


def test_the_summary_says_what_to_do_next(capsys: pytest.CaptureFixture[str]) -> None:
    print_summary(
        {
            "run": "runs/x",
            "moves": 40,
            "sim_s": 90.0,
            "wall_s": 250.0,
            "real_time_factor": 0.36,
            "digest": "ab",
        }
    )
    shown = capsys.readouterr().out
    assert "speed      0.36 times real time" in shown
    assert "next       swarm analyze runs/x" in shown
