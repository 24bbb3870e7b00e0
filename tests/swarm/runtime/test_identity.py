"""Identities: what makes two of them equal, and how a difference is told."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.runtime.handshake import compared
from swarm.runtime.identity import Fingerprint, RunIdentity, shown
from tests.support.swarm_runs import experiment_text, learners, write_experiment


def loaded(directory: Path, text: str) -> Experiment:
    return Experiment.load(write_experiment(directory, text))


@pytest.fixture
def experiment(tmp_path: Path) -> Experiment:
    return loaded(tmp_path, experiment_text(learners(2), moves=10))


def test_neither_the_order_nor_what_is_left_to_its_default_nor_the_processes_matter(
    tmp_path: Path, experiment: Experiment
) -> None:
    head, first, second = experiment_text(learners(2), moves=10).split("[[robot]]")
    text = f"{head}[learning]\nepsilon = 0.1\n[[robot]]{second}[[robot]]{first}"
    written_otherwise = loaded(tmp_path, text).changed(processes=1)
    identity = RunIdentity.of(experiment, 0)
    assert identity.differences(RunIdentity.of(written_otherwise, 0)) == []
    assert identity.fingerprint == RunIdentity.of(written_otherwise, 0).fingerprint


@pytest.mark.parametrize(
    ("extra", "difference"),
    [
        ("[learning]\nepsilon = 0.9", "learning.epsilon is 0.1 here and 0.9 there"),
        (
            '[learning]\napproach = "fixed"',
            'learning.approach is "average_q" here and "fixed" there',
        ),
        ("columns = 5", "arena.columns is 10 here and 5 there"),
        ('[tracker]\nbackend = "other"', 'tracker.backend is "sim" here and "other" there'),
    ],
)
def test_a_setting_that_differs_is_named_with_both_values(
    tmp_path: Path, experiment: Experiment, extra: str, difference: str
) -> None:
    other = loaded(tmp_path, experiment_text(learners(2), moves=10, extra=extra))
    here, there = RunIdentity.of(experiment, 0), RunIdentity.of(other, 0)
    assert here.differences(there) == [difference]
    assert here.fingerprint.differences(there.fingerprint) == ["its experiment has other settings"]


def test_what_the_command_line_changes_is_part_of_it(experiment: Experiment) -> None:
    here = RunIdentity.of(experiment, 0)
    there = RunIdentity.of(experiment.changed(seed=7, moves=20), 1)
    assert here.differences(there) == [
        "run.moves is 10 here and 20 there",
        "run.seed is 1 here and 7 there",
        "--trial is 0 here and 1 there",
    ]
    assert here.fingerprint.differences(there.fingerprint) == [
        "its experiment has other settings",
        "its seed is 7 and not 1",
        "its trial is 1 and not 0",
    ]


def test_a_robot_that_one_side_does_not_name_is_named_once(tmp_path: Path, experiment: Experiment) -> None:
    other = loaded(tmp_path, experiment_text(learners(1), moves=10))
    here, there = RunIdentity.of(experiment, 0), RunIdentity.of(other, 0)
    assert here.differences(there) == ["robot.r1 is only here"]
    assert there.differences(here) == ["robot.r1 is only there"]


def test_it_survives_the_wire_and_its_fingerprint_the_presence(experiment: Experiment) -> None:
    identity = RunIdentity.of(experiment.changed(seed=2**63 - 1), 3, "0123456789ab")
    assert RunIdentity.unpack(identity.pack()) == identity
    assert Fingerprint.parse(str(identity.fingerprint)) == identity.fingerprint


def test_of_many_differences_some_are_shown() -> None:
    assert shown("abcdefgh") == "a, b, c, d, e, f, and 2 more"


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"{}",
        b"[1]",
        b"\xff",
        b"[" * 100_000,
        b'{"settings": {}, "trial": 0, "schema": "", "run_id": ""}',
    ],
)
def test_an_answer_that_is_no_identity_is_refused(experiment: Experiment, answer: bytes) -> None:
    with pytest.raises(UserError, match="does not say whose run this is"):
        compared(answer, RunIdentity.of(experiment, 0))


def test_messages_of_another_version_are_refused(experiment: Experiment) -> None:
    mine = RunIdentity.of(experiment, 0)
    other = RunIdentity(mine.settings, 0, "another", "0123456789ab", "2.0.0")
    words = "is not this process's: the messages are of another version of the program, there 2.0.0"
    with pytest.raises(UserError, match=re.escape(words)):
        compared(other.pack(), mine)
    assert mine.fingerprint.differences(other.fingerprint) == [
        "its messages are of another version of the program"
    ]
