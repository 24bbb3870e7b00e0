"""The audit of the firewall between robots: a clean run, one with permitted access, one that leaks."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.cli.main import main
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.logs.crossings import FirewallAudit
from swarm.logs.firewall import audit
from swarm.logs.trial_logs import trials_of
from swarm.messages import topics
from swarm.messages.topics import Delivery
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.conftest import SmallRun
from tests.support.laboratory import SMALL_AND_QUICK, Laboratory, quick_text
from tests.support.operator import Operator, Order, moves
from tests.support.swarm_runs import experiment_text, learners, run_server, write_experiment


def audited(run: Path) -> FirewallAudit:
    (found,) = (audit(parts) for parts in trials_of(run))
    return found


def test_nothing_crosses_in_a_run_without_access(small_run: SmallRun) -> None:
    found = audited(small_run.directory)
    assert found.holds
    assert found.verdict == "nothing but observation crossed between 3 robots: 0 bytes in 6 pairs"
    assert {sum(counts.values()) for counts in found.pairs().values()} == {0}


def test_access_that_the_experiment_permits_is_told_in_bytes(tmp_path: Path) -> None:
    text = experiment_text(learners(2), 20, SMALL_AND_QUICK).replace(
        'id = "r1"', 'id = "r1"\naccesses = "r0"'
    )
    run_server(write_experiment(tmp_path, text), tmp_path / "run")
    found = audited(tmp_path / "run")
    assert found.holds
    ((crossing),) = found.permitted
    assert (crossing.source, crossing.robot, crossing.messages) == ("r0", "r1", 2)
    assert found.pairs()["r0", "r1"] == {"observed": 0, "permitted": crossing.bytes, "other": 0}
    assert found.pairs()["r1", "r0"]["permitted"] == 0
    assert found.verdict.startswith(
        "nothing but observation crossed, and the access that the experiment permits"
    )


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_a_robot_that_is_sent_another_s_moves_is_named_with_their_bytes(
    tmp_path: Path,
    stack: ExitStack,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Somebody passes on everything that r0 says of its moves, as poses to r1, in r0's name."""
    laboratory = Laboratory(tmp_path, stack, count=2)
    server = laboratory.serve()
    session = stack.enter_context(Session(SessionSettings(laboratory.endpoint)))
    operator = Operator(session)
    operator.sees()
    laboratory.track()
    agents = [laboratory.agent("r0"), laboratory.agent("r1")]
    overheard = session.inbox(topics.MOVE.key("r0"), Delivery.EVERY)
    to_r1 = session.publisher(topics.POSE.key("r1"), Delivery.EVERY)
    sent_bytes = 0
    while moves(operator.sees()) < 6 or not sent_bytes:
        for sample in overheard.poll():
            to_r1.put(sample.payload, attachment=sample.attachment)
            sent_bytes += len(sample.payload)
    assert operator.orders(Order.STOP).accepted
    for process in (server, *agents):
        process.communicate()
    run = tmp_path / "run"
    found = audited(run)
    ((crossing),) = found.violations
    assert (crossing.source, crossing.robot, crossing.key) == ("r0", "r1", "robot/r1/pose")
    assert 0 < crossing.bytes <= sent_bytes, "the hub drops poses that come all at once"
    assert found.pairs()["r0", "r1"]["other"] == crossing.bytes
    assert "refused" in json.dumps(found.as_json())
    monkeypatch.setattr("sys.argv", ["swarm", "check", "--firewall", str(run)])
    with pytest.raises(SystemExit, match="1"):
        main()
    assert str(crossing) in capsys.readouterr().err


def test_a_robot_that_gave_no_account_proves_nothing(small_run: SmallRun, tmp_path: Path) -> None:
    """The log alone, without what the processes of a simulation wrote beside it."""
    copy = tmp_path / "trial-000.mcap"
    copy.write_bytes((small_run.directory / "trial-000.mcap").read_bytes())
    found = audited(copy)
    assert not found.holds
    assert found.verdict.startswith("not shown: expert gave no account of what it received")


def test_access_is_to_a_learner_that_there_is(tmp_path: Path) -> None:
    text = quick_text(2).replace('id = "r1"', 'id = "r1"\naccesses = "r"')
    with pytest.raises(UserError, match="accesses 'r', which is no learner; did you mean 'r0'"):
        Experiment.load(write_experiment(tmp_path, text))
