"""A laboratory whose robots are emulated in this process, so that a test sees what their wheels do and when.

Everything else is real: server, tracker bridge and agents are processes, perhaps on machines of their own.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

from robot_agent.drivers.kinematics import STOPPED
from robot_agent.emulator.emulation import Emulation
from robot_agent.emulator.faults import Faults
from robot_agent.emulator.in_run import EmulatedInRun, emulation_of
from swarm.clock import NS_PER_S, unix_clock
from swarm.config.experiment import Experiment
from swarm.runtime.handshake import agreed_run
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.node import LiveNode
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.operator import Operator
from tests.support.swarm_runs import ROOT, write_experiment

AS_LIFE = Namespace(trial=0, speed=1.0)


class _OverError(Exception):
    """The test is over."""


def driving_text(robots: int) -> str:
    """Learners behind I2C that drive most of the time: cells of 30 cm take three seconds."""
    lines = ["[run]", 'name = "hands"', "moves = 100000", "[arena]", "width_m = 20.0", "height_m = 4.0"]
    lines += ["cell_m = 0.3", "[learning]", "epsilon = 1.0", "rest_s = 0.0", "blocked_move_s = 0.0"]
    for number in range(robots):
        lines += [
            "[[robot]]",
            f'id = "r{number}"',
            'driver = "i2c"',
            f"south_west_m = [{number * 3.3:.1f}, 0.0]",
        ]
    return "\n".join(lines) + "\n"


class EmulatedLaboratory:
    """Processes and emulated robots of one place, none of which outlives the block."""

    def __init__(self, directory: Path, stack: ExitStack, endpoint: str, robots: int) -> None:
        self.directory = directory
        self.endpoint = endpoint
        self.file = write_experiment(directory, driving_text(robots))
        self.names = [f"r{number}" for number in range(robots)]
        self._experiment = Experiment.load(self.file)
        self._stack = stack
        self.emulations = {name: self._emulated(name) for name in self.names}
        self._over = threading.Event()

    def start(self, *words: object, inside: Sequence[str] = ()) -> subprocess.Popen[bytes]:
        """A command of ours, perhaps on another machine."""
        command = [*inside, sys.executable, "-m", *map(str, words), "--insecure"]
        output = self._stack.enter_context((self.directory / f"{words[0]}.txt").open("ab"))
        process = subprocess.Popen(command, cwd=ROOT, stdout=output, stderr=subprocess.STDOUT)
        self._stack.enter_context(process)
        self._stack.callback(process.kill)
        return process

    def serve(
        self, listen: str = "", inside: Sequence[str] = (), *, resume: bool = False
    ) -> subprocess.Popen[bytes]:
        """The server, recording into `run`."""
        run = self.directory / "run"
        words = ("--resume", run) if resume else (self.file, "--out", run)
        return self.start("server", *words, "--listen", listen or self.endpoint, inside=inside)

    def track(self, endpoint: str = "", inside: Sequence[str] = ()) -> subprocess.Popen[bytes]:
        """The tracker bridge."""
        return self.start("tracker_bridge", self.file, "--connect", endpoint or self.endpoint, inside=inside)

    def agent(self, name: str, endpoint: str = "", inside: Sequence[str] = ()) -> subprocess.Popen[bytes]:
        """The agent of a robot, which keeps its state."""
        at = f"--address={name}={self.emulations[name].address}"
        state = ("--state", self.directory / "state")
        words = (self.file, "--connect", endpoint or self.endpoint, "--robot", name, at, *state)
        return self.start("robot_agent", *words, inside=inside)

    def session(self) -> Session:
        return self._stack.enter_context(Session(SessionSettings(self.endpoint, insecure=True)))

    def operator(self) -> Operator:
        return Operator(self.session())

    def emulate(self) -> None:
        """Tell the swarm where the emulated robots really are, as the emulator of a simulated run does."""
        thread = threading.Thread(target=self._emulate, daemon=True)
        thread.start()
        self._stack.callback(thread.join)
        self._stack.callback(self._over.set)

    def now_ns(self) -> int:
        """The emulated robots' clock."""
        return self.emulations[self.names[0]].now_ns()

    def drives(self, name: str) -> bool:
        """Whether a robot's wheels turn."""
        emulation = self.emulations[name]
        with emulation.lock:
            speeds = emulation.robot.speeds
            return bool(speeds) and speeds[-1][1] != STOPPED

    def stood_after_s(self, name: str, since_ns: int) -> float:
        """Seconds from a moment until a robot's wheels stood for good; infinity while they turn."""
        emulation = self.emulations[name]
        with emulation.lock:
            stood_ns = emulation.robot.standing_since_ns()
        return float("inf") if stood_ns is None else (stood_ns - since_ns) / NS_PER_S

    def _emulated(self, name: str) -> Emulation:
        address = f"unix:{self.directory / name}"
        return self._stack.enter_context(emulation_of(self._experiment, name, address, Faults(), AS_LIFE))

    def _emulate(self) -> None:
        identity = RunIdentity.of(self._experiment, 0)
        epoch = time.time_ns()
        with Session(SessionSettings(self.endpoint, insecure=True)) as session:
            claim(session, Presence("emulator", "robots", "here", epoch, str(identity.fingerprint)))
            run_id = agreed_run(session, identity, unix_clock())
            node = LiveNode(session, unix_clock(), 0.1, epoch, run_id)
            robots = [EmulatedInRun(emulation, node, name) for name, emulation in self.emulations.items()]
            with suppress(_OverError):
                node.run(lambda t_ns: self._step(robots))  # noqa: ARG005

    def _step(self, robots: list[EmulatedInRun]) -> None:
        if self._over.is_set():
            raise _OverError
        for robot in robots:
            robot.step()
