"""The agent's loop: observe, decide, act, learn, report."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from robot_agent.checkpoint import Checkpoint
from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import WheelSpeeds
from robot_agent.inbox import AgentInbox
from robot_agent.navigation.motion import Motion
from robot_agent.navigation.pose_estimator import PoseEstimator
from robot_agent.policies.policy import Policy, Transition
from robot_agent.reports import Reporter
from swarm.clock import NS_PER_S
from swarm.errors import UserError
from swarm.geometry import Compartment, Pose

if TYPE_CHECKING:
    from robot_agent.imitation.visit import BeginVisit, Visit


class Activity(Enum):
    """What the robot is about."""

    WAITING = "waiting"
    """For a pose, for the run, or for its turn to go on."""
    RETURNING = "returning"
    """Driving to the start cell, or back to the cell that it stood in."""
    DECIDING = "deciding"
    """Standing in a cell's centre."""
    MOVING = "moving"
    RESTING = "resting"
    """Standing still in the goal or in the start, between two journeys."""
    BLOCKED = "blocked"
    """Standing out a move into a wall."""
    VISITING = "visiting"
    """Watching another robot, or being carried there and back."""
    FINISHED = "finished"


STANDS_BETWEEN_MOVES = (Activity.WAITING, Activity.RETURNING, Activity.RESTING, Activity.DECIDING)


@dataclass(frozen=True, slots=True)
class Seen:
    """What one tick shows: the time, the robot's own pose, and how old the fix under it is."""

    t_ns: int
    pose: Pose | None
    pose_age_s: float


@dataclass(frozen=True, slots=True)
class Choice:
    """A decision under way."""

    state: int
    action: int
    next_state: int
    blocked: bool
    t_ns: int


class Agent:
    """One robot. Everything that it works with is handed to it."""

    def __init__(
        self,
        compartment: Compartment,
        policy: Policy,
        body: Body,
        estimator: PoseEstimator,
        motion: Motion,
        inbox: AgentInbox,
        reporter: Reporter,
        blocked_move_s: float,
        rest_s: float,
        begin_visit: BeginVisit | None = None,
    ) -> None:
        self.activity = Activity.WAITING
        self.state = compartment.grid.start
        """The cell that the robot stands in or is leaving."""
        self.policy = policy
        self.body = body
        self._compartment = compartment
        self._estimator = estimator
        self._motion = motion
        self._inbox = inbox
        self._reporter = reporter
        self._blocked_move_ns = round(blocked_move_s * NS_PER_S)
        self._rest_ns = round(rest_s * NS_PER_S)
        self._rest_until_ns = 0
        self._choice: Choice | None = None
        self._begin_visit = begin_visit
        self._visit: Visit | None = None
        self._lost = False
        self._checkpoint: Checkpoint | None = None

    def step(self, t_ns: int) -> None:
        """One tick."""
        seen = self.observe(t_ns)
        self.decide(seen)
        sent = self.act(seen)
        self.learn(seen)
        self.report(seen, sent)

    def observe(self, t_ns: int) -> Seen:
        """Wheel steps and tracker fixes into one estimate of the robot's own pose."""
        self._inbox.poll(t_ns)
        self._estimator.odometry(self.body.wheel_steps(t_ns), t_ns)
        for pose, captured_t_ns in self._inbox.fixes():
            self._estimator.fix(pose, captured_t_ns)
        if self._estimator.displaced:
            self._displaced()
        return Seen(t_ns, self._estimator.pose(t_ns), self._estimator.age_s(t_ns))

    def decide(self, seen: Seen) -> None:
        """Algorithm 3's choice, when the robot stands in a cell's centre and the run is on."""
        if self._inbox.stopped or self.policy.finished:
            self._stand(Activity.FINISHED if self.policy.finished else Activity.WAITING)
        elif self.activity is Activity.VISITING:
            self._end_visit_when_home(seen)
        elif self._inbox.visit_order and self._begin_visit and self.activity in STANDS_BETWEEN_MOVES:
            self._stand(Activity.VISITING)
            self.policy.abandon()
            self._visit = self._begin_visit(self._inbox.visit_order)
        elif self.activity is Activity.WAITING and self._is_at_home(seen) and self._inbox.running(seen.t_ns):
            self._go_to(self._cell_to_go_on_from(seen.pose), Activity.RETURNING)
        elif self.activity is Activity.DECIDING and self._inbox.running(seen.t_ns):
            self._begin(self.policy.choose(self.state), seen.t_ns)

    def act(self, seen: Seen) -> WheelSpeeds:
        """Drive as the motion says; what was really sent comes back."""
        if self._visit:
            speeds = self._visit.step(seen.pose, seen.t_ns)
        else:
            speeds = self._motion.step(seen.pose, seen.t_ns, seen.pose_age_s)
        return self.body.drive(speeds, seen.t_ns)

    def learn(self, seen: Seen) -> None:
        """Eq. 7 on arrival; from the goal the robot drives back to the start."""
        if self.activity is Activity.RETURNING and self._motion.arrived:
            self._rest(seen.t_ns)
        elif self.activity is Activity.RESTING and seen.t_ns >= self._rest_until_ns:
            self._begin_journey()
        elif self._choice and self._has_ended(self._choice, seen.t_ns):
            choice, self._choice = self._choice, None
            duration_s = (seen.t_ns - choice.t_ns) / NS_PER_S
            self.state = choice.next_state
            self.policy.learn(
                Transition(choice.state, choice.action, choice.next_state, duration_s, choice.blocked)
            )
            self.activity = Activity.DECIDING
            self._save()
            if self.state == self._compartment.grid.goal:
                self._rest(seen.t_ns)

    def report(self, seen: Seen, sent: WheelSpeeds) -> None:
        """The command as sent at every tick, the status once a second."""
        self._reporter.command(sent, seen.pose)
        self._reporter.status(seen.t_ns, self.activity.value, self.policy, seen.pose_age_s, self._inbox.bad)

    def resume_from(self, checkpoint: Checkpoint) -> None:
        """Keep the checkpoint up to date after every move, and go on from it if it has something."""
        self._checkpoint = checkpoint
        saved = checkpoint.load()
        if saved:
            try:
                self.policy.restore(saved["policy"])
                self.state = int(saved["state"])
            except (KeyError, TypeError, ValueError) as error:
                raise UserError(f"{checkpoint.path}: does not fit this experiment ({error})") from error

    def stop(self) -> None:
        """Motors off, for good."""
        self._motion.stop()
        self.body.close()

    def _begin(self, action: int, t_ns: int) -> None:
        entered = self._compartment.grid.neighbour(self.state, action)
        blocked = entered is None
        self._choice = Choice(self.state, action, self.state if entered is None else entered, blocked, t_ns)
        if blocked:
            self.activity = Activity.BLOCKED
        else:
            self._go_to(self._choice.next_state, Activity.MOVING, leaving=self.state)

    def _rest(self, t_ns: int) -> None:
        self.activity = Activity.RESTING
        self._rest_until_ns = t_ns + self._rest_ns

    def _begin_journey(self) -> None:
        """From the goal the robot drives back to the start; from anywhere else it may decide."""
        if self.state == self._compartment.grid.goal:
            self._go_to(self._compartment.grid.start, Activity.RETURNING)
        else:
            self.activity = Activity.DECIDING

    def _go_to(self, state: int, activity: Activity, leaving: int | None = None) -> None:
        self.state = state if leaving is None else leaving
        self.activity = activity
        self._motion.go_to(*self._compartment.centre(state))

    def _has_ended(self, choice: Choice, t_ns: int) -> bool:
        if choice.blocked:
            return t_ns - choice.t_ns >= self._blocked_move_ns
        return self._motion.arrived

    def _stand(self, activity: Activity) -> None:
        self._motion.stop()
        if self._choice:
            self._abandon_choice()
        self.activity = activity

    def _displaced(self) -> None:
        """Somebody carried the robot: nothing is learnt, and it goes on from the cell where it is now."""
        self._estimator.reset()
        if self._visit:
            self._visit.displaced()
            return
        self._stand(Activity.WAITING)
        self._lost = True
        self._reporter.event("displaced", f"carried away from cell {self.state}; the move is not learnt from")

    def _end_visit_when_home(self, seen: Seen) -> None:
        """After a visit a new journey begins at the start, as soon as the robot is back at home."""
        told = self._visit and self._visit.done and not self._inbox.visit_order
        if told and self._is_at_home(seen):
            self._visit = None
            self.state = self._compartment.grid.start
            self.activity = Activity.WAITING

    def _is_at_home(self, seen: Seen) -> bool:
        return seen.pose is not None and self._compartment.state_at(seen.pose.x_m, seen.pose.y_m) is not None

    def _cell_to_go_on_from(self, pose: Pose | None) -> int:
        """The cell that it was to stand in, or after it was carried away the one where it is."""
        if not self._lost or pose is None:
            return self.state
        self._lost = False
        state = self._compartment.state_at(pose.x_m, pose.y_m)
        grid = self._compartment.grid
        return grid.start if state is None or state == grid.goal else state

    def _save(self) -> None:
        """Once a move: a killed agent loses only the move that it was making."""
        if self._checkpoint:
            at_goal = self.state == self._compartment.grid.goal
            state = self._compartment.grid.start if at_goal else self.state
            self._checkpoint.save({"state": state, "policy": self.policy.snapshot()})

    def _abandon_choice(self) -> None:
        self._choice = None
        self.policy.abandon()
