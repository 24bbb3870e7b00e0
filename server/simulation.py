"""A simulated run: its trials one after the other, each with processes of its own."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from server.conductor import Conductor
from server.hand import SimulatedHand
from server.health import Health
from server.hub import Hub
from server.live_hub import LiveHub
from server.lockstep_hub import LockstepHub
from server.progress import RunProgress
from server.provenance import metadata
from server.recorder import Recorder, digest
from server.run_directory import RunDirectory
from server.run_table import Pace, run_table
from server.supervisor import Supervisor
from server.trial import Trial, TrialResult
from swarm.bus import Bus, BusSettings
from swarm.clock import scaled_clock
from swarm.experiment import Experiment
from swarm.presence import Presence, claim

LOCKSTEP_BATCHES_BETWEEN_FLUSHES = 1000
LIVE_FLUSH_S = 0.5


@dataclass
class Simulation:
    """Everything that a simulated run needs; `run` does it and returns what `--json` prints."""

    experiment: Experiment
    file: Path
    directory: RunDirectory
    speed: float | None
    """How many times as fast as life; None for lockstep, as fast as possible."""
    progress: RunProgress
    results: list[TrialResult] = field(default_factory=list)

    def run(self) -> dict[str, Any]:
        """All trials; the run's directory is complete after each of them."""
        began = time.monotonic()
        copy = self.directory.keep_experiment(self.file)
        self._write_manifest("running")
        state = "interrupted"
        try:
            for trial in range(self.experiment.run.trials):
                self.progress.begin(trial)
                self.results.append(self._trial(trial, copy))
            state = "complete"
        finally:
            self._write_manifest(state)
            summary = self._summary(time.monotonic() - began)
            self.directory.write_json("run.json", {**summary, **self._circumstances()})
        return summary

    def _trial(self, trial: int, file: Path) -> TrialResult:
        endpoint = f"tcp/127.0.0.1:{_free_port()}"
        pace = Pace(self.speed is None, self.speed or 1.0, time.monotonic_ns())
        specs = run_table(self.experiment, file, endpoint, trial, pace)
        with (
            Bus(BusSettings(endpoint, hub=True)) as bus,
            Supervisor(specs, self.directory.output(trial)) as supervisor,
        ):
            claim(bus, Presence("server", "server", socket.gethostname(), time.time_ns()))
            hub = self._hub(bus, [spec.name for spec in specs], pace, supervisor.check)
            conductor = Conductor(self.experiment, trial, hub.publish, SimulatedHand(hub.publish))
            recorder = Recorder(self.directory.log(trial), metadata(self.experiment, file, trial))
            flush_every = LOCKSTEP_BATCHES_BETWEEN_FLUSHES
            if not pace.lockstep:
                flush_every = max(1, round(LIVE_FLUSH_S * pace.speed / self.experiment.simulation.tick_s))
            health = Health(conductor.event)
            return Trial(hub, conductor, recorder, health, flush_every, self.progress.show).run()

    def _hub(self, bus: Bus, processes: list[str], pace: Pace, check: Callable[[], None]) -> Hub:
        tick_s = self.experiment.simulation.tick_s
        if pace.lockstep:
            return LockstepHub(bus, processes, tick_s, check, self.progress.warn)
        clock = scaled_clock(pace.started_ns, pace.speed)
        robots = [robot.id for robot in self.experiment.robot]
        return LiveHub(bus, clock, tick_s, time.time_ns(), robots, check, self.progress.warn)

    def _summary(self, wall_s: float) -> dict[str, Any]:
        logs = [self.directory.log(trial) for trial in range(self.experiment.run.trials)]
        logs = [log for log in logs if log.exists()]
        sim_s = sum(result.sim_s for result in self.results)
        return {
            "run": str(self.directory.path),
            "log": [str(log) for log in logs],
            "digest": digest(logs),
            "moves": sum(result.moves for result in self.results),
            "sim_s": round(sim_s, 3),
            "wall_s": round(wall_s, 3),
            "real_time_factor": round(sim_s / wall_s, 2),
        }

    def _circumstances(self) -> dict[str, Any]:
        """What differs between two repetitions of a run."""
        return {
            "ended": datetime.now(UTC).isoformat(),
            "host": socket.gethostname(),
            "command": sys.argv,
            "trials": [asdict(result) for result in self.results],
        }

    def _write_manifest(self, state: str) -> None:
        """Conditions x trials x seeds, one record each."""
        run = self.experiment.run
        records = [
            {
                "condition": robot.group,
                "robot": robot.id,
                "role": robot.role.value,
                "trial": trial,
                "seed": run.seed,
                "log": self.directory.log(trial).name,
                "state": "complete" if trial < len(self.results) else state,
            }
            for trial in range(run.trials)
            for robot in self.experiment.robot
        ]
        self.directory.write_json("manifest.json", {"name": run.name, "moves": run.moves, "trials": records})


def _free_port() -> int:
    """A port that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
