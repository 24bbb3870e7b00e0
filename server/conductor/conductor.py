"""Runs one trial: tells everyone that it has begun, follows the learners, and ends it."""

from __future__ import annotations

from collections.abc import Mapping

from server.conductor.camera_views import CameraViews
from server.conductor.carrier import Carrier
from server.conductor.copy_errors import CopyErrors
from server.conductor.earlier import EarlierProgress
from server.conductor.run_control import RunControl
from server.conductor.standstill import Standstill
from server.conductor.visits import Visits
from server.hubs.hub import Batch
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.errors import RunFailedError
from swarm.geometry import Grid
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.subscription import Received, Subscription, Subscriptions

RUN_STATE_PERIOD_NS = NS_PER_S
"""A robot that has not heard it for 5 s waits; so four may be lost."""


class Conductor:
    """Follows a trial from what is on the wire, and speaks to the robots by the same wire."""

    def __init__(
        self,
        experiment: Experiment,
        identity: RunIdentity,
        reporter: Reporter,
        carrier: Carrier,
        control: RunControl,
        earlier: Mapping[str, EarlierProgress] | None = None,
    ) -> None:
        self._experiment = experiment
        self._identity = identity
        self._reporter = reporter
        self._moves = Subscription(topics.MOVE)
        self._statuses = Subscription(topics.STATUS)
        self._best_paths = Subscription(topics.BEST_PATH)
        self._paths = Subscription(topics.PATH)
        self._visit_words = Subscription(topics.VISIT)
        self._observations = Subscription(topics.OBSERVATION)
        self._truths = Subscription(topics.TRUTH)
        learning = (self._moves, self._statuses, self._best_paths, self._paths)
        heard = (*learning, self._visit_words, self._observations)
        self._subscriptions = Subscriptions(heard)
        self._feeds_while_watching = Subscriptions((*heard, self._truths))
        self._goal = Grid(experiment.arena.columns, experiment.arena.rows).goal
        self._visits = Visits(experiment, reporter, carrier)
        self._camera_views = CameraViews(experiment, reporter)
        watched_by = {robot.id: robot.watches for robot in experiment.learners if robot.watches}
        self._copy_errors = CopyErrors(watched_by, reporter)
        self._control = control
        self._state_due_ns = 0
        self._announced: pb.RunState.Phase.ValueType | None = None
        self._standstill = Standstill(experiment)
        self._told_of: set[str] = set()
        self._ending = False
        self.lacks_room = False
        """Whether the robots are to stand after their moves because nothing can be recorded."""
        self.moves = {robot.id: 0 for robot in experiment.robot}
        """Moves made so far, by robot."""
        self.best_path = {robot.id: 0 for robot in experiment.learners}
        """The newest best path length, by learner; 0 before the first."""
        self._take_up(earlier or {})

    @property
    def ended(self) -> bool:
        """Whether everyone has been told that it is over: every learner has made its moves, or an operator
        stopped the trial.
        """
        return self._ending

    @property
    def stopped(self) -> str:
        """Who ended the trial before its time, and why; empty if nobody did."""
        return self._control.stopped

    @property
    def phase(self) -> pb.RunState.Phase.ValueType:
        """What the trial is about now."""
        if self._ending:
            return pb.RunState.ENDED
        phase = self._control.phase
        return pb.RunState.PAUSED if self.lacks_room and phase == pb.RunState.RUNNING else phase

    @property
    def bad_messages(self) -> int:
        """Messages refused so far."""
        return self._feeds_while_watching.bad

    def step(self, batch: Batch) -> None:
        """Take in a batch; announce the run's state once a second and when it changes."""
        watching = self._visits.watching
        (self._feeds_while_watching if watching else self._subscriptions).put(batch.items)
        for move in self._moves.take():
            self._note_move(move, batch.t_ns)
        for status in self._statuses.take():
            self._note_status(status)
        for best in self._best_paths.take():
            self.best_path[best.robot] = best.message.length
        self._conduct_visits(batch.t_ns)
        done = all(self.moves[learner] >= self._experiment.run.moves for learner in self.best_path)
        self._ending = done or bool(self._control.stopped)
        if self.phase != pb.RunState.RUNNING:
            self._standstill.excused(self.moves, batch.t_ns)
        self._standstill.excused(self._control.paused_robots, batch.t_ns)
        if batch.t_ns >= self._state_due_ns or self._ending or self.phase != self._announced:
            self._state_due_ns = batch.t_ns + RUN_STATE_PERIOD_NS
            self._control.repeat_pauses()
            self.announce(self.phase)

    def _take_up(self, earlier: Mapping[str, EarlierProgress]) -> None:
        """Go on from where the trial was when its last server ended."""
        for robot in self.moves.keys() & earlier.keys():
            self.moves[robot] = earlier[robot].moves
            self._visits.take_up(robot, earlier[robot])

    def _note_move(self, received: Received[pb.Move], t_ns: int) -> None:
        robot, move = received.robot, received.message
        self.moves[robot] = move.number
        self._standstill.moved(robot, t_ns)
        self._told_of.discard(robot)
        self._copy_errors.moved(robot, move, received.header.t_ns)
        if move.next_state == self._goal:
            self._visits.track_ended(robot, move.track)

    def _note_status(self, received: Received[pb.Status]) -> None:
        """A robot tells here of moves that nobody heard, made without a server or before this one began."""
        robot = received.robot
        if robot in self.moves:
            self.moves[robot] = max(received.message.moves, self.moves[robot])
            self._control.resumes(robot, received.message)

    def _conduct_visits(self, t_ns: int) -> None:
        for path in self._paths.take():
            if path.message.visit:
                self._visits.path_remembered(path.robot)
        for observation in self._observations.take():
            self._copy_errors.observed(observation.robot, observation.message)
        for word in self._visit_words.take():
            self._visits.heard(word.robot, word.message)
            if word.message.phase == pb.Visit.DONE:
                self._copy_errors.visit_done(word.robot, word.message, t_ns)
        self._copy_errors.step(t_ns)
        if self.phase == pb.RunState.RUNNING:
            self._visits.order_due(t_ns)
        self._camera_views.step(self._truths.take(), self._visits.watching)

    def check_progress(self, t_ns: int) -> None:
        """RunFailedError if a robot stands for ever: a simulation waits for nobody."""
        standing = self._standstill.standing(self.moves, t_ns)
        if standing:
            raise RunFailedError(f"{', '.join(standing)}: {self._for_how_long}")

    def newly_standing(self, t_ns: int) -> list[str]:
        """A line for each robot that stands for ever, once, until it moves again; it is in the log too."""
        standing = set(self._standstill.standing(self.moves, t_ns)) - self._told_of
        self._told_of |= standing
        lines = [f"{robot}: {self._for_how_long}" for robot in sorted(standing)]
        for line in lines:
            self._reporter.event("stands", line, pb.Event.WARNING)
        return lines

    @property
    def _for_how_long(self) -> str:
        return f"no move for {self._standstill.limit_s / 60:.0f} min of the run"

    def announce(self, phase: pb.RunState.Phase.ValueType) -> None:
        """Tell everyone the phase of the trial."""
        self._announced = phase
        identity = self._identity
        state = pb.RunState(phase=phase, trial=identity.trial, experiment=self._experiment.run.name)
        if identity.run_id:
            state.run_id, state.identity = identity.run_id, str(identity.fingerprint)
        self._reporter.publish(topics.RUN_STATE, state)
