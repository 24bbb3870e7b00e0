"""Processes of a run: started, watched, and none left behind."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from server.processes.supervisor import ProcessSpec, Supervisor
from swarm.errors import RunFailedError

WAIT_FOR_EVER = "import signal; print('started', flush=True); signal.pause()"
FAIL = "import sys; print('first'); sys.exit('no body answers on /dev/rfcomm0')"


@pytest.fixture
def code(tmp_path: Path) -> Path:
    file = tmp_path / "program.py"
    file.write_text("import sys\nexec(sys.argv[1])\n")
    return file


def spec(code: Path, name: str, program: str) -> ProcessSpec:
    return ProcessSpec(name, "tests.support.run_file", (str(code), program))


def wait_for_the_end(pid: int) -> None:
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)


def is_there(pid: int) -> bool:
    return Path(f"/proc/{pid}").exists()


def check_after_the_end(supervisor: Supervisor, name: str) -> None:
    wait_for_the_end(supervisor.pids[name])
    supervisor.check()


def interrupt(supervisor: Supervisor) -> None:
    """What Ctrl-C does while everyone lives."""
    supervisor.check()
    raise KeyboardInterrupt


def test_a_process_that_ends_is_named_with_its_last_words(code: Path, tmp_path: Path) -> None:
    supervisor = Supervisor(
        [spec(code, "tracker", WAIT_FOR_EVER), spec(code, "robots-0", FAIL)], tmp_path / "output"
    )
    with pytest.raises(RunFailedError) as error, supervisor:
        check_after_the_end(supervisor, "robots-0")
    who = f"process robots-0 (pid {supervisor.pids['robots-0']})"
    assert str(error.value) == f"{who} ended with code 1, saying: no body answers on /dev/rfcomm0"
    assert not any(is_there(pid) for pid in supervisor.pids.values()), "the other was ended"


def test_a_killed_process_is_named_with_the_signal(code: Path, tmp_path: Path) -> None:
    program = "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"
    supervisor = Supervisor([spec(code, "a", program)], tmp_path / "output")
    with pytest.raises(RunFailedError, match=r"process a \(pid \d+\) was killed by SIGKILL"), supervisor:
        check_after_the_end(supervisor, "a")


def test_an_interrupted_run_ends_its_processes(code: Path, tmp_path: Path) -> None:
    supervisor = Supervisor([spec(code, "a", WAIT_FOR_EVER)], tmp_path / "output")
    with pytest.raises(KeyboardInterrupt), supervisor:
        interrupt(supervisor)
    assert not is_there(supervisor.pids["a"])


def test_an_orderly_end_waits_for_everyone(code: Path, tmp_path: Path) -> None:
    with Supervisor([spec(code, "a", "print('done', flush=True)")], tmp_path / "output") as supervisor:
        pid = supervisor.pids["a"]
    assert not is_there(pid)
    assert (tmp_path / "output" / "a.log").read_text() == "done\n"


def test_processes_are_out_of_reach_of_the_terminal(code: Path, tmp_path: Path) -> None:
    """Ctrl-C goes to the server alone, which ends the run in order."""
    program = "import os; print(os.getpgid(0) == os.getpid())"
    with Supervisor([spec(code, "a", program)], tmp_path / "output"):
        pass
    assert (tmp_path / "output" / "a.log").read_text() == "True\n"
