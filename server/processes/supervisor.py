"""Starts the processes of a simulated swarm, watches them, and ends them."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from server.processes.cpu_affinity import keep, spread
from swarm.errors import RunFailedError
from swarm.interpreter import child_environment, module_command
from swarm.parallel import available_cores

LEAVE_WITHIN_S = 5.0
"""A process leaves after its step, which takes far less; one that has not by then hangs."""


@dataclass(frozen=True)
class ProcessSpec:
    """One line of the run table: a process's name, its module, and its arguments."""

    name: str
    module: str
    arguments: tuple[str, ...]


class Supervisor:
    """The processes of one trial, as a context manager: none outlives the block.

    They run in process groups of their own, so that Ctrl-C reaches the server alone, which then ends the
    trial in order. (In sessions of their own the kernel would schedule each against all others, and a
    lockstep would run at a third of the speed.) What they print goes to one file each. Each keeps to its
    core of `cores`.
    """

    def __init__(self, specs: list[ProcessSpec], output: Path, cores: Sequence[int] | None = None) -> None:
        self._specs = specs
        self._cores = cores or spread(len(specs), available_cores())
        self._output = output
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> Supervisor:
        self._output.mkdir(parents=True, exist_ok=True)
        for number, spec in enumerate(self._specs):
            self._processes[spec.name] = self._started(spec, number)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._signal(signal.SIGTERM)
        for process in self._processes.values():
            try:
                process.wait(LEAVE_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def check(self) -> None:
        """RunFailedError if a process has ended: which, how, and the last line it printed."""
        ended = [name for name, process in self._processes.items() if process.poll() is not None]
        if ended:
            raise RunFailedError("; ".join(self._how_ended(name) for name in ended))

    @property
    def core_of(self) -> dict[int, int]:
        """The core of each process, by process id."""
        return dict(zip(self.pids.values(), self._cores, strict=True))

    @property
    def pids(self) -> dict[str, int]:
        """Process ids by name."""
        return {name: process.pid for name, process in self._processes.items()}

    def _started(self, spec: ProcessSpec, number: int) -> subprocess.Popen[bytes]:
        with self._log(spec.name).open("wb") as output:
            process = subprocess.Popen(
                module_command(spec.module, *spec.arguments),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                process_group=0,
                env={**child_environment(), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            )
        keep(process.pid, self._cores[number])
        return process

    def _how_ended(self, name: str) -> str:
        process = self._processes[name]
        code = process.returncode
        how = f"was killed by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        lines = self._log(name).read_text(errors="replace").strip().splitlines()
        said = f", saying: {lines[-1]}" if lines else ""
        return f"process {name} (pid {process.pid}) {how}{said}"

    def _log(self, name: str) -> Path:
        return self._output / f"{name}.log"

    def _signal(self, number: int) -> None:
        for process in self._processes.values():
            if process.poll() is None:
                process.send_signal(number)
