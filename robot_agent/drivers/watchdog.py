"""The process that owns a robot's link, and stops its wheels when its agent no longer tells it what to do.

An agent may be killed or stopped at any moment; what survives it has to be outside it. So the agent starts
this small process and speaks with it over a socket pair (`watchdog_messages`). A command holds until its
deadline. Without a fresh one, or when the agent's end of the socket closes, the wheels are told to stand;
when the link is lost it is opened anew, and the first thing that the robot hears is a stop.
"""

from __future__ import annotations

import importlib
import os
import select
import signal
import socket
import sys
import time
from collections.abc import Callable
from contextlib import suppress

from robot_agent.drivers.robot_link import Actuators, HasCamera, LinkError, Reading, ReplyError, RobotLink
from robot_agent.drivers.watchdog_messages import Answer, Event, Identity, Picture, Request

NS_PER_S = 1_000_000_000
IDLE_EXCHANGE_NS = NS_PER_S // 10
"""An idle robot is told to stand ten times a second: a TV remote in the room could drive it."""
REPEAT_STOP_NS = NS_PER_S // 50
"""How soon a stop that got no answer is repeated."""
REOPEN_NS = NS_PER_S // 2
"""How long a lost link is left alone between two attempts."""
GIVE_UP_NS = 10 * NS_PER_S
"""Without its agent, the watchdog tries to stop the robot for so long over a lost link."""

MISTAKE = "mistake in the link's driver, please report it"

OpenLink = Callable[[], RobotLink]


class Watchdog:
    """What the process does, with time as an argument: `now_ns` is the machine's monotonic clock, run at
    the run's speed."""

    def __init__(
        self, open_link: OpenLink, now_ns: Callable[[], int], report: Callable[[bytes], None]
    ) -> None:
        self._open_link = open_link
        self._now_ns = now_ns
        self._report = report
        self._link: RobotLink | None = None
        self._wanted = Actuators()
        self._deadline_ns = 0
        self._due_ns = 0
        self._reopen_ns = 0
        self._lost_ns: int | None = None
        self._identity = ""
        self._stands = False
        self.failures = 0
        """Exchanges without a good answer."""
        self.refused = 0
        """Commands that came after their deadline."""

    @property
    def due_ns(self) -> int:
        """When it has to act by itself."""
        if self._link is None:
            return self._reopen_ns
        return min(self._due_ns, self._deadline_ns) if self._moving else self._due_ns

    @property
    def _moving(self) -> bool:
        return bool(self._wanted.left or self._wanted.right)

    def obey(self, request: Request) -> Answer:
        """Take a command over unless it is stale, speak with the robot, and answer the agent."""
        stands = not (request.left or request.right)
        self._stands = False
        if request.drives and (stands or request.deadline_ns > self._now_ns()):
            self._wanted = Actuators(request.left, request.right, request.lights)
            self._deadline_ns = request.deadline_ns
        elif request.drives:
            self.refused += 1
        if request.image and not self._moving:
            self._report_picture()
        return Answer.of(request.number, self._now_ns(), self.act(), self.failures, self.refused)

    def _report_picture(self) -> None:
        if isinstance(self._link, HasCamera):
            with suppress(ReplyError, LinkError, OSError):
                began_ns = self._now_ns()
                if picture := self._link.picture():
                    width, height, data = picture
                    self._report(Picture(began_ns, width, height, data).pack())

    def stand(self) -> bool:
        """See to it that the robot stands; whether it has said that it does."""
        self._deadline_ns = 0
        return self._stands or self.act() is not None

    def act(self) -> Reading | None:
        """One exchange with the robot; None if it gave no good answer."""
        now_ns = self._now_ns()
        stops = self._moving and now_ns >= self._deadline_ns
        if stops:
            self._wanted = Actuators(lights=self._wanted.lights)
        reading = self._exchanged(now_ns)
        heard = reading is not None
        self._stands = heard and not self._moving
        self._due_ns = self._now_ns() + (IDLE_EXCHANGE_NS if heard or self._moving else REPEAT_STOP_NS)
        return reading

    def _exchanged(self, now_ns: int) -> Reading | None:
        if self._link is None and not self._opened(now_ns):
            return None
        assert self._link
        try:
            return self._link.exchange(self._wanted)
        except ReplyError:
            self.failures += 1
        except (LinkError, OSError) as error:
            self._lose(f"link lost: {error}")
        except Exception as error:
            # A mistake in a link's own code must not end what stops the robot.
            self._lose(f"{MISTAKE}: {error!r}")
        return None

    def _opened(self, now_ns: int) -> bool:
        """Try to open the link, not too often. What was wanted before is not wanted any more."""
        if now_ns < self._reopen_ns:
            return False
        try:
            self._link = self._open_link()
        except (LinkError, ReplyError, OSError) as error:
            self._reopen_ns = self._now_ns() + REOPEN_NS
            if not self._identity:
                self._report(Event(f"no link yet: {error}").pack())
            return False
        self._wanted = Actuators()
        self._identity = self._link.identity
        self._report(Identity(self._link.identity, self._link.motors).pack())
        if self._lost_ns is not None:
            away_s = (self._now_ns() - self._lost_ns) / NS_PER_S
            self._report(Event(f"link is back after {away_s:.1f} s").pack())
            self._lost_ns = None
        return True

    def _lose(self, why: str) -> None:
        assert self._link
        with suppress(OSError):
            self._link.close()
        self._link = None
        self._wanted = Actuators()
        self._lost_ns = self._now_ns()
        self._reopen_ns = self._lost_ns
        self._report(Event(why).pack())

    def close(self) -> None:
        if self._link:
            self._link.close()
            self._link = None


def link_opener(opener: str) -> Callable[[str], RobotLink]:
    """The function that MODULE:FUNCTION names."""
    module, _, function = opener.partition(":")
    found: Callable[[str], RobotLink] = getattr(importlib.import_module(module), function)
    return found


def serve(agent: socket.socket, watchdog: Watchdog, now_ns: Callable[[], int], speed: float) -> None:
    """Obey the agent until it is gone, and then stop the robot."""
    while (request := _next_request(agent, watchdog, now_ns, speed)) is not None:
        if request:
            with suppress(OSError):
                agent.send(watchdog.obey(Request.unpack(request)).pack())
        else:
            watchdog.act()
    give_up_ns = now_ns() + GIVE_UP_NS
    while not watchdog.stand() and now_ns() < give_up_ns:
        select.select([], [], [], REPEAT_STOP_NS / NS_PER_S)
    watchdog.close()


def _next_request(
    agent: socket.socket, watchdog: Watchdog, now_ns: Callable[[], int], speed: float
) -> bytes | None:
    """What the agent says; nothing when the watchdog has to act first, None when the agent is gone."""
    wait_s = max(0.0, (watchdog.due_ns - now_ns()) / NS_PER_S / speed)
    ready, _, _ = select.select([agent], [], [], wait_s)
    if not ready:
        return b""
    try:
        return agent.recv(Request.SIZE) or None
    except OSError:
        return None


def main() -> None:
    """`python -m robot_agent.drivers.watchdog FD MODULE:FUNCTION ADDRESS SPEED`, started by the agent.

    Signals that end an agent do not end its watchdog: it ends when the agent's end of the socket closes.
    """
    descriptor, opener, address, speed_text = sys.argv[1:5]
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    speed = float(speed_text)

    def now_ns() -> int:
        return int(time.monotonic_ns() * speed)

    agent = socket.socket(fileno=int(descriptor))

    def report(message: bytes) -> None:
        with suppress(OSError):
            agent.send(message)

    try:
        open_link = link_opener(opener)
    except (ImportError, AttributeError) as error:
        report(Event(f"no link: {error}").pack())
        return
    serve(agent, Watchdog(lambda: open_link(address), now_ns, report), now_ns, speed)


if __name__ == "__main__":
    main()
