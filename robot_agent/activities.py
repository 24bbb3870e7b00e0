"""What a robot can be about, each with its own transitions (the state pattern).

An activity may pass into another at the beginning of a tick (`decide`) or once the wheels have their speeds
(`act`). The run's end, a displaced robot and a finished policy interrupt any of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from robot_agent.drivers.kinematics import STOPPED, WheelSpeeds
from robot_agent.inbox import AgentInbox
from robot_agent.navigation.motion import Motion
from robot_agent.policies.policy import Policy
from swarm.clock import NS_PER_S
from swarm.geometry import Compartment, Pose
from swarm.learning.learner import Transition

if TYPE_CHECKING:
    from robot_agent.imitation.visit import BeginVisit, Visit


class Seen(NamedTuple):
    """What one tick shows: the time, the robot's own pose, and how old the fix under it is."""

    t_ns: int
    pose: Pose | None
    pose_age_s: float


class Acted(NamedTuple):
    """What an activity makes of a tick: wheel speeds, what follows it, and the move that has just ended."""

    speeds: WheelSpeeds
    then: Activity
    made: Transition | None = None


@dataclass(frozen=True)
class Task:
    """What a robot has to do, and with what: the same for all its activities."""

    compartment: Compartment
    policy: Policy
    motion: Motion
    inbox: AgentInbox
    blocked_move_s: float
    rest_s: float
    begin_visit: BeginVisit | None = None
    """None in a robot without a camera."""

    def is_at_home(self, pose: Pose | None) -> bool:
        return pose is not None and self.compartment.state_at(pose.x_m, pose.y_m) is not None

    def cell(self, saved: object) -> int:
        """A cell that was saved; ValueError if the compartment has none of that number."""
        cells = self.compartment.grid.states
        if type(saved) is not int or not 0 <= saved < cells:
            raise ValueError(f"cell {saved!r} is none of 0 to {cells - 1}")
        return saved

    def drive_to(self, state: int) -> None:
        self.motion.go_to(*self.compartment.centre(state))


@dataclass(frozen=True)
class Activity:
    """What the robot is about, from `enter` until another activity follows."""

    task: Task
    state: int
    """The cell that the robot stands in or is leaving."""
    name: ClassVar[str]
    """As the status message has it."""
    under_way: ClassVar[bool] = False
    """Whether a pause waits for its end."""

    def enter(self) -> None:
        """Called once, when the activity begins."""

    def decide(self, seen: Seen) -> Activity:  # noqa: ARG002
        """What to be about in this tick."""
        return self

    def act(self, seen: Seen) -> Acted:
        """Drive as the motion says."""
        return Acted(self.task.motion.step(seen.pose, seen.t_ns, seen.pose_age_s), self)

    def stopped(self) -> Activity:
        """What follows when the run does not go on: a move under way is given up."""
        return Waiting(self.task, self.state)

    def emergency(self) -> Activity:
        """What follows when an emergency stop is heard: whatever is under way is given up."""
        return EmergencyStop(self.task, self.stopped().state)

    def displaced(self) -> Activity:
        """What follows when somebody carried the robot away: a move under way is given up."""
        return Waiting(self.task, self.state, lost=True)


class BetweenMoves(Activity):
    """May be interrupted by an order to watch another robot."""

    def decide(self, seen: Seen) -> Activity:
        order, begin_visit = self.task.inbox.visit_order, self.task.begin_visit
        if order is None or begin_visit is None:
            return self.go_on(seen)
        self.task.policy.abandon()
        return Visiting(self.task, self.state, begin_visit(order))

    def go_on(self, seen: Seen) -> Activity:  # noqa: ARG002
        """What to be about without such an order."""
        return self


@dataclass(frozen=True)
class Waiting(BetweenMoves):
    """For a pose, for the run, or for its turn to go on."""

    name = "waiting"
    lost: bool = False
    """Whether the robot may stand anywhere, and not in the cell `state`."""

    def enter(self) -> None:
        self.task.motion.stop()

    def go_on(self, seen: Seen) -> Activity:
        if self.task.is_at_home(seen.pose) and self.task.inbox.running:
            return Returning(self.task, self._cell_to_go_on_from(seen.pose))
        return self

    def stopped(self) -> Activity:
        return self

    def _cell_to_go_on_from(self, pose: Pose | None) -> int:
        """The cell that it was to stand in, or after it was carried away the one where it is."""
        if not self.lost or pose is None:
            return self.state
        state = self.task.compartment.state_at(pose.x_m, pose.y_m)
        grid = self.task.compartment.grid
        return grid.start if state is None or state == grid.goal else state


class Returning(BetweenMoves):
    """Driving to the start cell, or back to the cell that it stood in."""

    name = "returning"
    under_way = True

    def enter(self) -> None:
        self.task.drive_to(self.state)

    def act(self, seen: Seen) -> Acted:
        acted = super().act(seen)
        return (
            Acted(acted.speeds, resting(self.task, self.state, seen)) if self.task.motion.arrived else acted
        )


@dataclass(frozen=True)
class Resting(BetweenMoves):
    """Standing still in the goal or in the start, between two journeys."""

    name = "resting"
    until_ns: int

    def act(self, seen: Seen) -> Acted:
        acted = super().act(seen)
        return Acted(acted.speeds, self._journey()) if seen.t_ns >= self.until_ns else acted

    def _journey(self) -> Activity:
        """From the goal the robot drives back to the start; from anywhere else it may decide."""
        grid = self.task.compartment.grid
        return (
            Returning(self.task, grid.start) if self.state == grid.goal else Deciding(self.task, self.state)
        )


def resting(task: Task, state: int, seen: Seen) -> Resting:
    return Resting(task, state, seen.t_ns + round(task.rest_s * NS_PER_S))


class Deciding(BetweenMoves):
    """Standing in a cell's centre: algorithm 3's choice is next."""

    name = "deciding"

    def go_on(self, seen: Seen) -> Activity:
        if not self.task.inbox.running:
            return self
        action = self.task.policy.choose(self.state)
        entered = self.task.compartment.grid.neighbour(self.state, action)
        if entered is None:
            return Blocked(self.task, self.state, action, self.state, seen.t_ns)
        return Moving(self.task, self.state, action, entered, seen.t_ns)


@dataclass(frozen=True)
class MoveUnderWay(Activity, ABC):
    """A choice under way, from the decision at `began_ns` until there is something to learn from it."""

    under_way = True
    blocked: ClassVar[bool]
    action: int
    next_state: int
    began_ns: int

    def act(self, seen: Seen) -> Acted:
        acted = super().act(seen)
        return Acted(acted.speeds, self._next(seen), self._made(seen)) if self.has_ended(seen) else acted

    @abstractmethod
    def has_ended(self, seen: Seen) -> bool:
        """Whether there is something to learn."""

    def stopped(self) -> Activity:
        self.task.policy.abandon()
        return super().stopped()

    def displaced(self) -> Activity:
        self.task.policy.abandon()
        return super().displaced()

    def _made(self, seen: Seen) -> Transition:
        duration_s = (seen.t_ns - self.began_ns) / NS_PER_S
        return Transition(self.state, self.action, self.next_state, duration_s, self.blocked)

    def _next(self, seen: Seen) -> Activity:
        at_goal = self.next_state == self.task.compartment.grid.goal
        return resting(self.task, self.next_state, seen) if at_goal else Deciding(self.task, self.next_state)


class Moving(MoveUnderWay):
    """Driving to the next cell."""

    name = "moving"
    blocked = False

    def enter(self) -> None:
        self.task.drive_to(self.next_state)

    def has_ended(self, seen: Seen) -> bool:  # noqa: ARG002
        return self.task.motion.arrived


class Blocked(MoveUnderWay):
    """Standing out a move into a wall."""

    name = "blocked"
    blocked = True

    def has_ended(self, seen: Seen) -> bool:
        return seen.t_ns - self.began_ns >= round(self.task.blocked_move_s * NS_PER_S)


@dataclass(frozen=True)
class Visiting(Activity):
    """Watching another robot, or being carried there and back."""

    name = "visiting"
    under_way = True
    visit: Visit

    def enter(self) -> None:
        self.task.motion.stop()

    def decide(self, seen: Seen) -> Activity:
        """After a visit a new journey begins at the start, as soon as the robot is back at home."""
        home = self.visit.done and not self.task.inbox.visit_order and self.task.is_at_home(seen.pose)
        return Waiting(self.task, self.task.compartment.grid.start) if home else self

    def act(self, seen: Seen) -> Acted:
        return Acted(self.visit.step(seen.pose, seen.t_ns), self)

    def displaced(self) -> Activity:
        """Being carried is part of a visit."""
        self.visit.displaced()
        return self


class EmergencyStop(Activity):
    """Standing until somebody releases the emergency; wherever the robot is then, it goes on from there."""

    name = "estopped"

    def enter(self) -> None:
        self.task.motion.stop()

    def decide(self, seen: Seen) -> Activity:  # noqa: ARG002
        """Asked only once the emergency is released."""
        return Waiting(self.task, self.state, lost=True)

    def act(self, seen: Seen) -> Acted:  # noqa: ARG002
        """At once: no braking is planned."""
        return Acted(STOPPED, self)

    def emergency(self) -> Activity:
        return self

    def stopped(self) -> Activity:
        """Also a trial that is over leaves it in force."""
        return self

    def displaced(self) -> Activity:
        """People carry robots in emergencies."""
        return self


class Finished(Activity):
    """All moves are made."""

    name = "finished"

    def enter(self) -> None:
        self.task.motion.stop()
