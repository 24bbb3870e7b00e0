"""A whole run with certificates: everybody has the rights that a run needs, over a server's death too."""

from __future__ import annotations

import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.logs.check import check_run
from tests.support.certified import CertifiedLaboratory
from tests.support.laboratory import Laboratory

pytestmark = pytest.mark.faults


def test_a_run_with_certificates_outlives_its_server(tmp_path: Path) -> None:
    certified = CertifiedLaboratory(tmp_path)
    with ExitStack() as stack:
        laboratory = Laboratory(tmp_path, stack, moves=15)
        laboratory.endpoint = certified.endpoint
        server = laboratory.serve("--credentials", certified.keys("server"))
        tracker = laboratory.track("--credentials", certified.keys("tracker"))
        agent = laboratory.agent("r0", "--credentials", certified.keys("robot-r0"))
        _wait_for_line(agent, "connected to the server at tls/")
        saved = tmp_path / "state" / "r0.json"
        while not saved.exists():
            assert server.poll() is None
        server.kill()
        _wait_for_line(agent, "lost the server")
        again = laboratory.serve("--resume", tmp_path / "run", "--credentials", certified.keys("server"))
        _, said = again.communicate()
        assert again.returncode == 0, said
        _wait_for_line(agent, "resumed: the server is back")
        for process in (agent, tracker):
            process.communicate()
            assert process.returncode == 0
    last = check_run(tmp_path / "run")[-1]
    assert not [fault for fault in last.faults if "trial-000-2" in fault]


def _wait_for_line(process: subprocess.Popen[str], start: str) -> None:
    assert process.stderr is not None
    while not (line := process.stderr.readline()).startswith(start):
        assert line, f"it ended without saying {start!r}"
