"""`--set`: a value of the command line is checked as one of the file, and an error names the option."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from tests.support.swarm_runs import experiment_text, write_experiment


def load(directory: Path, *changes: str) -> Experiment:
    return Experiment.load(write_experiment(directory, experiment_text()), changes)


def test_any_key_of_any_table_may_be_set(tmp_path: Path) -> None:
    experiment = load(
        tmp_path,
        "learning.epsilon=0.3",
        "learning.approach=completion",
        'tracker.axes="x -z y"',
        "arena.height_m=3",
        "robot.expert.south_west_m=[0.0, 1.5]",
        "robot.loner.watches=expert",
        "robot.imitator.paths=[]",
        "run.moves=7",
    )
    assert (experiment.learning.epsilon, experiment.learning.approach.value) == (0.3, "completion")
    assert (experiment.tracker.axes, experiment.run.moves) == ("x -z y", 7)
    assert experiment.robot_named("loner").watches == "expert"
    assert experiment.robot_named("imitator").paths == ()


def test_the_last_of_two_for_one_key_counts(tmp_path: Path) -> None:
    assert load(tmp_path, "run.moves=7", "run.moves=8").run.moves == 8


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("learning.epsilon", "--set learning.epsilon: say TABLE.KEY=VALUE"),
        ("epsilon=1", "--set epsilon=1: say TABLE.KEY=VALUE"),
        ("robot.imitator=1", "--set robot.imitator=1: say TABLE.KEY=VALUE"),
        (
            "learning.epsilom=0.3",
            "--set learning.epsilom=0.3: unknown key 'epsilom'; did you mean 'epsilon'?",
        ),
        ("lerning.epsilon=0.3", "--set lerning.epsilon=0.3: unknown key 'lerning'; did you mean 'learning'?"),
        ("learning.epsilon=3", "--set learning.epsilon=3: 'epsilon' is 3.0; it has to be at least 0"),
        ("learning.epsilon=much", "--set learning.epsilon=much: 'epsilon' is a number, not 'much'"),
        ("robot.imitater.watches=loner", "no robot is called 'imitater'; did you mean 'imitator'?"),
        ("robot.imitator.watches=nobody", "--set robot.imitator.watches=nobody: 'imitator' watches 'nobody'"),
        ("arena.cell_m=0.5", r"small\.toml:\d+ with --set arena.cell_m=0.5: the compartment of"),
    ],
)
def test_what_cannot_be_set_is_told_by_its_option(tmp_path: Path, change: str, told: str) -> None:
    with pytest.raises(UserError, match=told.replace("?", r"\?")):
        load(tmp_path, change)
