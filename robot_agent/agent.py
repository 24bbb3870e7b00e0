"""The agent's loop: observe, decide, act, learn, report."""

from __future__ import annotations

from robot_agent.activities import (
    Activity,
    EmergencyStop,
    Finished,
    MoveUnderWay,
    Seen,
    Task,
    Visiting,
    Waiting,
)
from robot_agent.checkpoint import Checkpoint, Saved
from robot_agent.drivers.health import TellsHealth
from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import STOPPED, WheelSpeeds
from robot_agent.navigation.pose_estimator import PoseEstimator
from robot_agent.reports import Reporter
from swarm.errors import UserError, in_words
from swarm.learning.learner import Transition


class Agent:
    """One robot. Everything that it works with is handed to it."""

    def __init__(self, task: Task, body: Body, estimator: PoseEstimator, reporter: Reporter) -> None:
        self.activity: Activity = Waiting(task, task.compartment.grid.start)
        self._task = task
        self._body = body
        self._tells_health = body if isinstance(body, TellsHealth) else None
        self._estimator = estimator
        self._reporter = reporter
        self._checkpoint: Checkpoint | None = None
        self._saves = True
        self._told_pause = False

    def step(self, t_ns: int) -> None:
        """One tick."""
        seen = self.observe(t_ns)
        self.decide(seen)
        sent, made = self.act(seen)
        self.learn(made)
        self.report(seen, sent)

    def observe(self, t_ns: int) -> Seen:
        """Wheel steps and tracker fixes into one estimate of the robot's own pose."""
        self._task.inbox.poll(t_ns)
        self._estimator.odometry(self._body.wheel_steps(t_ns), t_ns)
        for pose, captured_t_ns in self._task.inbox.fixes():
            self._estimator.fix(pose, captured_t_ns)
        if self._estimator.displaced:
            self._displaced()
        return Seen(t_ns, self._estimator.pose(t_ns), self._estimator.age_s(t_ns))

    def decide(self, seen: Seen) -> None:
        """Whether the robot may go on, and with what."""
        if self._task.inbox.latch.engaged:
            self._stop_at_once(self._task.inbox.latch.reason)
        elif self._task.policy.finished:
            self._become(Finished(self._task, self.activity.state))
        elif self._task.inbox.stopped:
            if self._task.inbox.server_lost and self._gives_up:
                self._reporter.warning("server_lost", f"the server is silent{self._gives_up}")
            self._become(self.activity.stopped())
        else:
            self._become(self.activity.decide(seen))

    def act(self, seen: Seen) -> tuple[WheelSpeeds, Transition | None]:
        """Drive, but not out of touch; what was really sent comes back, and the move that has just ended."""
        acted = self.activity.act(seen)
        sent = self._body.drive(STOPPED if self._task.inbox.cut_off else acted.speeds, seen.t_ns)
        self._become(acted.then)
        return sent, acted.made

    def learn(self, made: Transition | None) -> None:
        """Eq. 7 on arrival; saved once a move: a killed agent loses only the one that it was making."""
        if made:
            self._task.policy.learn(made)
            self._save(made.next_state)

    def keep_emergency(self) -> None:
        """Have an emergency stop that is in force outlive this process."""
        try:
            self._task.inbox.latch.keep()
        except OSError as error:
            text = f"the emergency stop would not outlive this process: {in_words(error)}"
            self._reporter.warning("estop", text)

    def report(self, seen: Seen, sent: WheelSpeeds) -> None:
        """The command as sent at every tick, the status once a second."""
        policy = self._task.policy
        self._tell_pause()
        self._reporter.command(sent, seen.pose)
        self._reporter.status(
            seen.t_ns,
            self.activity.name,
            policy.moves,
            policy.tracks,
            seen.pose_age_s,
            self._task.inbox.bad,
            self._tells_health.health if self._tells_health else None,
            paused=self._task.inbox.paused,
            estopped=self._task.inbox.latch.engaged,
        )

    def resume_from(self, checkpoint: Checkpoint) -> str:
        """Keep the checkpoint up to date after every move, and go on from it if it has something.

        What the robot goes on from is put into the log, and returned for the terminal; empty if nothing.
        """
        self._checkpoint = checkpoint
        saved = checkpoint.load()
        if saved is None:
            return ""
        try:
            self._task.policy.restore(saved.policy)
            self.activity = Waiting(self._task, self._task.cell(saved.state))
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            raise UserError(f"{checkpoint.path}: does not fit this experiment ({error})") from error
        return self._tell_resumed(saved)

    def _tell_resumed(self, saved: Saved) -> str:
        where = "this run" if saved.same_run else f"another run, {saved.run_id}"
        text = f"goes on after move {self._task.policy.moves} from what it learnt in {where}"
        tell = self._reporter.info if saved.same_run else self._reporter.warning
        tell("resumed", text)
        return text

    def stop(self) -> None:
        """Motors off, for good."""
        self._task.motion.stop()
        self._body.close()

    def _stop_at_once(self, reason: str) -> None:
        if not isinstance(self.activity, EmergencyStop):
            text = f"{reason}: the wheels stand until it is released{self._gives_up}"
            self._reporter.warning("estop", text)
            self._become(self.activity.emergency())

    @property
    def _gives_up(self) -> str:
        """What a stop costs, for the log: who replays it has to know of a choice that came to nothing."""
        if not isinstance(self.activity, MoveUnderWay):
            return ""
        return f"; the move from cell {self.activity.state} is not learnt from"

    def _tell_pause(self) -> None:
        """Once it stands, and once it may go on: what became of the operator's order."""
        held = self._task.inbox.held
        if held and not self._told_pause and not self.activity.under_way:
            self._told_pause = True
            self._reporter.info("paused", f"stands: {held}")
        elif not held and self._told_pause:
            self._told_pause = False
            self._reporter.info("resumed", "may go on")

    def _become(self, activity: Activity) -> None:
        if activity is not self.activity:
            self.activity = activity
            activity.enter()

    def _displaced(self) -> None:
        """Somebody carried the robot: nothing is learnt, and it goes on from the cell where it is now."""
        self._estimator.reset()
        state = self.activity.state
        self._become(self.activity.displaced())
        if not isinstance(self.activity, Visiting):
            text = f"carried away from cell {state}; the move is not learnt from"
            self._reporter.warning("displaced", text)

    def _save(self, state: int) -> None:
        """From the goal a restarted robot goes on at the start."""
        if self._checkpoint:
            grid = self._task.compartment.grid
            state = grid.start if state == grid.goal else state
            self._keep(self._checkpoint, state)

    def _keep(self, checkpoint: Checkpoint, state: int) -> None:
        """A full disk is no reason to stand still: the robot goes on, and says what a restart would lose."""
        try:
            checkpoint.save(state, self._task.policy.snapshot())
        except OSError as error:
            if self._saves:
                self._reporter.warning("checkpoint", f"what is learnt is not saved: {in_words(error)}")
            self._saves = False
        else:
            self._saves = True
