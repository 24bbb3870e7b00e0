"""What the operator wants of a run: it decides about every order, and says what the run's phase is.

The conductor announces the phase; the robots obey it. Everything that was ordered is an event in the log.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from server.conductor.prompts import Prompts, is_done
from server.reporter import Reporter
from swarm.errors import in_words, nearest, one_line
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.emergency_latch import EmergencyLatch, by

Order = pb.OperatorOrder


class RefusedError(Exception):
    """An order that is not carried out: the text says why, to whoever gave it."""


class RunControl:
    """What holds now of all that was ordered."""

    def __init__(
        self,
        robots: Sequence[str],
        reporter: Reporter,
        latch: EmergencyLatch,
        prompts: Prompts,
        pose_of: Callable[[str], Pose | None],
    ) -> None:
        self._robots = robots
        self._reporter = reporter
        self._latch = latch
        self._prompts = prompts
        self._pose_of = pose_of
        self.paused_robots: set[str] = set()
        """Robots that are paused by themselves, whether or not the run is."""
        self.paused = latch.engaged
        self.stopped = ""
        """Who ended the trial before its time, and why; empty if nobody did."""
        self.reason = latch.reason
        """Why the run is not under way; empty if it is."""
        self._obeys: dict[int, Callable[[Order], str]] = {
            Order.PAUSE: self._pause,
            Order.RESUME: self._resume,
            Order.STOP: self._stop,
            Order.ESTOP: self._estop,
            Order.RELEASE: self._release,
            Order.DONE: self._done,
        }

    @property
    def phase(self) -> pb.RunState.Phase.ValueType:
        """What the run is about, as far as people have a say in it."""
        if self.stopped:
            return pb.RunState.ENDED
        if self._latch.engaged:
            return pb.RunState.ESTOPPED
        return pb.RunState.PAUSED if self.paused else pb.RunState.RUNNING

    def obey(self, order: pb.OperatorOrder) -> pb.OrderAnswer:
        """Carry an order out, or refuse it; either way the log tells of it."""
        try:
            done = self._obeys[order.kind](order)
        except RefusedError as error:
            self._reporter.event("refused", f"{said(order)}: {error}", pb.Event.WARNING)
            return pb.OrderAnswer(accepted=False, text=str(error))
        self._reporter.event("order", f"{said(order)}: {done}", pb.Event.WARNING)
        return pb.OrderAnswer(accepted=True, text=done)

    def emergency(self, stop: pb.EmergencyStop) -> None:
        """The server has heard an emergency stop, as the robots have."""
        reason = by(stop.operator, stop.reason)
        if self._engaged(reason):
            self._reporter.event("estop", f"emergency stop by {reason}", pb.Event.ERROR)

    def resumes(self, robot: str, status: pb.Status) -> None:
        """Tell a robot that still stands although it is no longer paused: it missed the order."""
        if status.paused and robot not in self.paused_robots:
            self._reporter.publish(topics.ORDER, pb.Order(kind=pb.Order.RESUME), robot)

    def repeat_pauses(self) -> None:
        """Tell the robots that are paused by themselves once more: one may have been started again."""
        for robot in sorted(self.paused_robots):
            self._reporter.publish(topics.ORDER, pb.Order(kind=pb.Order.PAUSE), robot)

    def _pause(self, order: Order) -> str:
        robots = self._named(order)
        if robots:
            self.paused_robots |= set(robots)
            self.repeat_pauses()
            return f"{', '.join(robots)} will stand after the move or visit under way"
        if self.paused:
            raise RefusedError("the run is paused already")
        self.paused, self.reason = True, by(order.operator, order.reason)
        return "every robot will stand after the move or visit under way"

    def _resume(self, order: Order) -> str:
        if self._latch.engaged:
            raise RefusedError(f"emergency stop by {self._latch.reason}: release it first")
        robots = self._named(order)
        if robots:
            return self._resume_robots(robots)
        if not self.paused:
            raise RefusedError("the run is not paused")
        self.paused, self.reason = False, ""
        still = f"; {', '.join(sorted(self.paused_robots))} stay paused" if self.paused_robots else ""
        return f"the run goes on{still}"

    def _resume_robots(self, robots: Sequence[str]) -> str:
        going = [robot for robot in robots if robot in self.paused_robots]
        if not going:
            raise RefusedError(f"{', '.join(robots)}: not paused")
        self.paused_robots -= set(going)
        for robot in going:
            self._reporter.publish(topics.ORDER, pb.Order(kind=pb.Order.RESUME), robot)
        return f"{', '.join(going)} will go on{' once the run does' if self.paused else ''}"

    def _stop(self, order: Order) -> str:
        self.stopped = self.reason = by(order.operator, order.reason)
        return "the trial ends now; its log will be closed in order"

    def _estop(self, order: Order) -> str:
        reason = by(order.operator, order.reason)
        self._engaged(reason)
        before = "" if self._latch.reason == reason else f" (as {self._latch.reason} ordered before)"
        return f"every wheel stands until the emergency is released{before}"

    def _engaged(self, reason: str) -> bool:
        """Whether this is a new emergency; it holds from now on, also for a server that goes on here."""
        is_new = self._latch.engage(reason)
        if is_new:
            self.paused, self.reason = True, f"emergency stop by {reason}"
            try:
                self._latch.keep()
            except OSError as error:
                text = f"the emergency stop would not outlive the server: {in_words(error)}"
                self._reporter.event("estop", text, pb.Event.ERROR)
        return is_new

    def _release(self, order: Order) -> str:
        """Also if nothing is in force here: a robot may have heard of an emergency that the server missed."""
        self._latch.release()
        self.reason = by(order.operator, "released, and paused until somebody resumes it")
        self.paused = True
        for robot in self._robots:
            self._reporter.publish(topics.ORDER, pb.Order(kind=pb.Order.RELEASE), robot)
        return "released; the run is paused: resume it when everybody is clear"

    def _done(self, order: Order) -> str:
        asked = self._prompts.numbered(order.prompt)
        if asked is None:
            raise RefusedError(f"no prompt {order.prompt} waits")
        pose = self._pose_of(asked.robot)
        if pose is not None and not is_done(asked, pose):
            away_m, at = asked.place.distance_m(pose), f"x {pose.x_m:.2f} m, y {pose.y_m:.2f} m"
            raise RefusedError(f"{asked.robot} stands {away_m:.2f} m from there by its own pose, at {at}")
        self._prompts.close(asked)
        return f"{asked.robot} stands where it is wanted"

    def _named(self, order: Order) -> Sequence[str]:
        for name in order.robots:
            if name not in self._robots:
                raise RefusedError(f"no robot {one_line(name, 32)!r}; {nearest(name, self._robots)}")
        return list(order.robots)


def said(order: pb.OperatorOrder) -> str:
    """An order as the log tells of it."""
    what = [Order.Kind.Name(order.kind).lower(), *order.robots[:10]]
    what += [f"prompt {order.prompt}"] if order.prompt else []
    return f"{' '.join(one_line(word, 32) for word in what)} by {by(order.operator, order.reason)}"
