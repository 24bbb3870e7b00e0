"""Experiment files that are right, and every way in which one can be wrong: file, line, and the cure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from swarm.config.experiment import Experiment, Role
from swarm.errors import UserError
from swarm.learning.memory import Approach
from tests.support.swarm_runs import ROOT, write_experiment

GOOD = """[run]
name = "trial-1"
moves = 100

[arena]
width_m = 3.0

[learning]
epsilon = 0.2
approach = "completion"

[[robot]]
id = "teacher"
role = "expert"
south_west_m = [0.0, 0.0]

[[robot]]
id = "pupil"
south_west_m = [1.5, 0.0]
paths = [["SE", "SE"], ["E"]]
"""


def load(directory: Path, text: str) -> Experiment:
    return Experiment.load(write_experiment(directory, text))


def test_a_good_file_and_its_defaults(tmp_path: Path) -> None:
    experiment = load(tmp_path, GOOD)
    assert (experiment.run.name, experiment.run.moves, experiment.run.trials) == ("trial-1", 100, 1)
    assert (experiment.learning.epsilon, experiment.learning.approach) == (0.2, Approach.COMPLETION)
    assert (experiment.learning.beta, experiment.learning.discount_rate_per_s) == (0.5, 0.149)
    teacher, pupil = experiment.robot
    assert (teacher.role, pupil.role, pupil.group) == (Role.EXPERT, Role.LEARNER, "learner")
    assert [str(path) for path in pupil.given_paths()] == ["SE-SE", "E"]
    assert experiment.learners == (pupil,)
    assert experiment.compartment(pupil).centre(0) == pytest.approx((1.56, 1.14))


@pytest.mark.parametrize("name", ["run", "tracker", "server", "view"])
def test_names_that_tables_use_otherwise_are_no_robot_s(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=rf"small\.toml:\d+: 'id' is '{name}', as in keys that name no robot"):
        load(tmp_path, GOOD.replace("pupil", name))


def test_what_the_command_line_changes(tmp_path: Path) -> None:
    experiment = load(tmp_path, GOOD)
    changed = experiment.changed(seed=7, moves=3, processes=2)
    assert (changed.run.seed, changed.run.moves, changed.simulation.processes) == (7, 3, 2)
    assert experiment.changed() == experiment


def test_an_exchange_is_no_longer_than_a_camera_waits_between_frames(tmp_path: Path) -> None:
    slow = "[simulation]\nticks_per_exchange = 4\n"
    alone = load(tmp_path, GOOD + slow)
    watching = replace(alone, robot=(alone.robot[0], replace(alone.robot[1], watches=alone.robot[0].id)))
    quick = replace(watching, visits=replace(watching.visits, frames_per_s=20.0))
    assert [one.ticks_per_exchange for one in (alone, watching, quick)] == [4, 2, 1]


@pytest.mark.parametrize("file", sorted((ROOT / "deploy" / "sim").glob("*.toml")), ids=lambda file: file.name)
def test_the_experiments_that_come_with_the_project_load(file: Path) -> None:
    assert Experiment.load(file).learners


WRONG = {
    "unknown key": ("epsilon", "epsilom", ":9: unknown key 'epsilom'; did you mean 'epsilon'?"),
    "unknown table": ("[arena]", "[arenas]", ":5: unknown key 'arenas'; did you mean 'arena'?"),
    "wrong type": ("moves = 100", 'moves = "many"', ":3: 'moves' is a whole number, not 'many'"),
    "no whole number": ("moves = 100", "moves = 1.5", ":3: 'moves' is a whole number, not 1.5"),
    "truth as number": ("moves = 100", "moves = true", ":3: 'moves' is a whole number, not True"),
    "out of range": ("epsilon = 0.2", "epsilon = 1.2", ":9: 'epsilon' is 1.2; it has to be at least 0 and"),
    "not finite": ("epsilon = 0.2", "epsilon = nan", ":9: 'epsilon' is nan; a finite number"),
    "unknown choice": (
        '"completion"',
        '"complet"',
        ":10: 'approach' is 'complet'; did you mean 'completion'?",
    ),
    "no learner": ('paths = [["SE", "SE"], ["E"]]', 'role = "expert"', "no robot is a learner"),
    "missing key": ('id = "pupil"\n', "", ":17: 'id' is missing in [robot]"),
    "bad id": ('"pupil"', '"../pupil"', ":18: 'id' is '../pupil'; an id starts with a small letter"),
    "bad run name": ('"trial-1"', '"Trial 1"', ":2: 'name' is 'Trial 1'; an id starts with"),
    "two of one id": ('"pupil"', '"teacher"', ":18: two robots are called 'teacher'"),
    "overlap": ("[1.5, 0.0]", "[1.0, 0.0]", ":19: the compartments of 'teacher' and 'pupil' overlap"),
    "out of the arena": (
        "[1.5, 0.0]",
        "[1.9, 0.0]",
        ":19: the compartment of 'pupil' reaches out of the arena",
    ),
    "a place of three": ("[1.5, 0.0]", "[1.5, 0.0, 0.0]", ":19: 'south_west_m' has 3 values; it takes 2"),
    "no list": ("[1.5, 0.0]", "1.5", ":19: 'south_west_m' is a list, not 1.5"),
    "unknown move": ('["E"]', '["EAST"]', ":20: a path is a list of moves out of E, SE"),
    "a path that is no list": (
        '[["SE", "SE"], ["E"]]',
        '["SE"]',
        ":20: 'paths' is a list of lists, such as [['SE']]; 'SE' is no list",
    ),
    "one bracket": (
        """[[robot]]
id = "teacher"
role = "expert"
south_west_m = [0.0, 0.0]

[[robot]]""",
        "[robot]",
        ":12: there may be several: write [[robot]], with two brackets, above each",
    ),
    "a table as a choice": ('"completion"', "{ a = 1 }", ":10: 'approach' is {'a': 1}; known: "),
    "a very long value": ("moves = 100", f'moves = "{"x" * 5000}"', "xxx..."),
    "too deep": ("moves = 100", f"moves = {'[' * 5000}", "not valid TOML: brackets in brackets, too deep"),
    "no TOML": ("[arena]", "[arena", "not valid TOML"),
}


@pytest.mark.parametrize(("before", "after", "said"), WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_explained_in_one_line(tmp_path: Path, before: str, after: str, said: str) -> None:
    assert before in GOOD
    with pytest.raises(UserError) as error:
        load(tmp_path, GOOD.replace(before, after, 1))
    assert str(error.value).startswith(str(tmp_path / "small.toml"))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_paths_beyond_the_memory_and_for_an_expert(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r":21: 2 paths do not fit in \[learning\] capacity"):
        load(tmp_path, GOOD.replace("epsilon = 0.2", "epsilon = 0.2\ncapacity = 1"))
    with pytest.raises(UserError, match=r":16: 'teacher' is no learner: it cannot be given paths"):
        load(tmp_path, GOOD.replace("[0.0, 0.0]", '[0.0, 0.0]\npaths = [["E"]]'))


def test_a_robot_alone_is_told_that_there_is_nobody_to_watch(tmp_path: Path) -> None:
    text = '[run]\nname = "x"\n[[robot]]\nid = "a"\nsouth_west_m = [0.0, 0.0]\nwatches = "zz"\n'
    with pytest.raises(UserError, match=":6: 'a' watches 'zz'; there is no other robot"):
        load(tmp_path, text)


def test_a_visit_has_no_more_frames_than_one_message_holds(tmp_path: Path) -> None:
    watching = GOOD.replace('id = "pupil"', 'id = "pupil"\nwatches = "teacher"').replace("0.0]", "0.05]")
    load(tmp_path, watching + "[visits]\nduration_s = 600\nframes_per_s = 0.8\n")
    with pytest.raises(UserError, match=r"toml:\d+: 600 s at 5 frames a second are 3000 frames of a visit"):
        load(tmp_path, watching + "[visits]\nduration_s = 600\n")


def test_a_file_that_is_not_there_or_no_text(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no such file"):
        Experiment.load(tmp_path / "none.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UserError, match="cannot be read as text"):
        Experiment.load(tmp_path / "binary.toml")
    with pytest.raises(UserError, match="cannot be read as text"):
        Experiment.load(tmp_path)
