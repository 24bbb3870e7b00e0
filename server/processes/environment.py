"""What a trial plays on: simulated robots in processes of ours, or the robots of a laboratory."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from server.conductor.carrier import Carrier, Operator, SimulatedCarrier
from server.conductor.prompts import Prompts
from server.hubs.hub import Hub
from server.hubs.live import LiveHub
from server.hubs.lockstep import LockstepHub
from server.processes.cpu_affinity import keeping_to, place, spread
from server.processes.placement_probe import PlacementProbe
from server.processes.run_table import Pace, emulated_addresses, run_table
from server.processes.supervisor import Supervisor
from server.reporter import Reporter
from swarm.clock import scaled_clock, unix_clock
from swarm.config.experiment import REAL_LINKS, Experiment
from swarm.errors import UserError
from swarm.logs.ending import Sender
from swarm.parallel import available_cores
from swarm.plugins import TRACKERS, plugins
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.lockstep import patient
from swarm.runtime.zenoh_session import Session, SessionSettings

LOCKSTEP_BATCHES_BETWEEN_FLUSHES = 1000
"""Of one tick each: a third of a second at 300 times real time. More often makes more, smaller chunks."""
LIVE_FLUSH_S = 0.5
"""Real seconds of messages that a killed server may lose."""


Warn = Callable[[str], None]


@dataclass(frozen=True)
class TrialPlan:
    """Which trial is to be played: its identity, the experiment's file, where its processes print to."""

    identity: RunIdentity
    file: Path
    output: Path
    earlier: Mapping[Sender, int] = field(default_factory=dict)
    """The last number of each sender in the logs that an earlier server left."""

    @property
    def trial(self) -> int:
        return self.identity.trial


@dataclass(frozen=True)
class TrialEnvironment:
    """Where the messages come together, who speaks for the server, who carries robots, and how often the
    log is flushed.
    """

    hub: Hub
    reporter: Reporter
    carrier: Carrier
    batches_between_flushes: int
    warn: Warn
    """Shows a line to whoever watches."""
    prompts: Prompts
    session: Session | None = None
    """Where people's orders and questions come in; None in a lockstep, which nobody can join."""
    waits_for_people: bool = False


Environment = Callable[[TrialPlan], AbstractContextManager[TrialEnvironment]]
"""`simulated` or `laboratory`, with all but the plan given."""


@contextmanager
def simulated(
    experiment: Experiment, speed: float | None, warn: Warn, plan: TrialPlan, *, emulate: bool = False
) -> Iterator[TrialEnvironment]:
    """Processes on this machine, in lockstep (`speed` None) or so many times as fast as life.

    Robots with real links are emulated if `emulate` says so.
    """
    pace = Pace(speed is None, speed or 1.0, time.monotonic_ns())
    cores = available_cores()
    with (
        socket_endpoint() as endpoint,
        keeping_to(cores[0]) if pace.lockstep else nullcontext(),
        Session(_hub_settings(endpoint, pace)) as session,
        TemporaryDirectory(prefix="robots-") as sockets,
    ):
        emulated = emulated_addresses(experiment, Path(sockets)) if emulate else {}
        trial = plan.identity.trial
        specs = run_table(experiment, plan.file, endpoint, trial, pace, plan.output, emulated)
        presence = _presence(plan.identity)
        claim(session, presence)
        with Supervisor(specs, plan.output, spread(len(specs), cores)) as supervisor:
            core_of = {os.getpid(): cores[0], **supervisor.core_of}
            probe = PlacementProbe(partial(place, core_of, cores))
            hub, flush_every = _hub(
                experiment, plan.identity, session, pace, supervisor, warn, probe, presence.epoch
            )
            reporter = Reporter(hub)
            asked = None if pace.lockstep else session
            carrier = SimulatedCarrier(reporter)
            yield TrialEnvironment(hub, reporter, carrier, flush_every, warn, Prompts(), asked)


def require_emulation(experiment: Experiment, speed: float | None, *, emulate: bool) -> None:
    """UserError for a robot that a simulation could not reach, or that cannot be emulated like this."""
    real = [robot for robot in experiment.robot if robot.driver in REAL_LINKS]
    if real and not emulate:
        raise UserError(
            f"robot {real[0].id!r} has driver {real[0].driver!r}: a simulation needs --emulate and --speed X"
        )
    if emulate and speed is None:
        raise UserError("--emulate needs --speed X: bytes on a link take their own time")
    if emulate and not real:
        raise UserError(f"--emulate: no robot's driver is one of {', '.join(REAL_LINKS)}")


def require_tracker(experiment: Experiment, speed: float | None) -> None:
    """UserError for a tracking system that goes by a time of its own, which a lockstep does not wait for."""
    name = experiment.tracker.backend
    if speed is None and plugins(TRACKERS)[name].load().poll_s is not None:
        raise UserError(
            f'[tracker] backend is {name!r}, which has a time of its own: a simulation needs "sim", or '
            f"--speed X and a program that plays {name}"
        )


def _hub_settings(endpoint: str, pace: Pace) -> SessionSettings:
    settings = SessionSettings(endpoint, hub=True)
    return patient(settings) if pace.lockstep else settings


def _hub(
    experiment: Experiment,
    identity: RunIdentity,
    session: Session,
    pace: Pace,
    supervisor: Supervisor,
    warn: Warn,
    probe: PlacementProbe,
    epoch: int,
) -> tuple[Hub, int]:
    """The hub of a pace, and how many of its batches come between two flushes."""
    if not pace.lockstep:
        clock = scaled_clock(pace.started_ns, pace.speed)
        live = LiveHub(session, clock, experiment, identity, supervisor.check, warn, epoch)
        return live, _live_flush(experiment, pace.speed)
    names, ticks = list(supervisor.pids), experiment.ticks_per_exchange
    tick_s = experiment.simulation.tick_s
    hub = LockstepHub(
        session,
        names,
        tick_s,
        supervisor.check,
        warn,
        ticks_per_exchange=ticks,
        exchanged=probe.exchanged,
    )
    return hub, LOCKSTEP_BATCHES_BETWEEN_FLUSHES // ticks


@contextmanager
def socket_endpoint() -> Iterator[str]:
    """A socket file that only this user can open: no port is taken, and a message takes less time."""
    with TemporaryDirectory(prefix="swarm-") as place:
        yield f"unixsock-stream/{place}/hub"


@contextmanager
def laboratory(
    experiment: Experiment,
    session: Session,
    warn: Warn,
    going_on: Callable[[], None],
    plan: TrialPlan,
) -> Iterator[TrialEnvironment]:
    """Robots and a tracker bridge that others start: the server waits for them, and people carry robots.

    They are not ours to check: who is missing shows by presence and health. `going_on` is called every tick.
    """
    presence = _presence(plan.identity)
    claim(session, presence)
    clock = unix_clock()
    hub = LiveHub(session, clock, experiment, plan.identity, going_on, warn, presence.epoch, plan.earlier)
    reporter = Reporter(hub)
    prompts = Prompts()
    carrier, flush_every = Operator(reporter, warn, prompts), _live_flush(experiment, 1.0)
    yield TrialEnvironment(hub, reporter, carrier, flush_every, warn, prompts, session, waits_for_people=True)


def _presence(identity: RunIdentity) -> Presence:
    return Presence("server", "server", socket.gethostname(), time.time_ns(), str(identity.fingerprint))


def _live_flush(experiment: Experiment, speed: float) -> int:
    return max(1, round(LIVE_FLUSH_S * speed / experiment.simulation.tick_s))
