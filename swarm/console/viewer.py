"""One page that looks at a run: which moment it shows, and what it has been told already."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

from swarm.console.about import about_run
from swarm.console.learner_view import learner_view, observation_view
from swarm.console.moment import frame
from swarm.console.run_history import RunHistory

SLOWEST, FASTEST = 0.1, 1000.0
"""Times as fast as the run was."""
TRAIL_S = 40.0
"""Behind each robot; a journey along the diagonal takes half of it."""
MOST_AT_ONCE = 2000
"""Points of curves and events in one message: less than the page takes in at a frame."""


class Viewer:
    """A moment of a run that plays, stands still, or follows what is being said."""

    def __init__(self, history: RunHistory, *, live: bool) -> None:
        self.history = history
        self.live = live
        """Whether the newest moment is shown, whatever the pace."""
        self.playing = True
        self.speed = 10.0
        self.cursor_s = 0.0
        self.selected = next(robot.id for robot in history.experiment.learners)
        self._shown_s: float | None = None
        """The moment of the last frame; None if the page has to draw anew."""
        self._shown_learner: tuple[str, int, int] | None = None
        self._told: Counter[tuple[str, str]] = Counter()
        self._answers: list[dict[str, Any]] = []
        self._introduced = False
        self._heard = 0
        """Messages that the last frame took into account."""

    def asked(self, words: Any) -> None:
        """Do what the page asks; what makes no sense changes nothing."""
        if not isinstance(words, dict):
            return
        match words:
            case {"ask": "play"}:
                self._play()
            case {"ask": "pause"}:
                self.playing = self.live = False
            case {"ask": "live"}:
                self.live = self.playing = True
                self._shown_s = None
            case {"ask": "speed", "times": int() | float() as times} if math.isfinite(times):
                self.speed = min(FASTEST, max(SLOWEST, float(times)))
                self.live = False
            case {"ask": "seek", "t_s": int() | float() as t_s} if math.isfinite(t_s):
                self._seek(float(t_s))
            case {"ask": "move", "robot": str(robot), "number": int(number)}:
                self._seek_move(robot, number)
            case {"ask": "select", "robot": str(robot)} if robot in self.history.robots:
                self.selected = robot
            case {"ask": "observation", "robot": str(robot), "visit": int(visit)} if (
                robot in self.history.robots
            ):
                self._answers += filter(None, [observation_view(self.history, robot, visit)])

    def advance(self, elapsed_s: float) -> None:
        """Let so much real time pass."""
        if self.live:
            self.cursor_s = self.history.end_s
        elif self.playing:
            self.cursor_s = min(self.history.end_s, self.cursor_s + elapsed_s * self.speed)

    def step(self, elapsed_s: float) -> list[dict[str, Any]]:
        """Let so much real time pass, and say what the page has to be told then."""
        with self.history.lock:
            self.advance(elapsed_s)
            return list(self.messages())

    def messages(self) -> Iterator[dict[str, Any]]:
        """What the page has to be told now."""
        if not self._introduced:
            self._introduced = True
            yield about_run(self.history)
        if growth := self._growth():
            yield growth
        if self._shown_s != self.cursor_s or self._heard_more():
            yield self._frame()
        yield from self._learner()
        answers, self._answers = self._answers, []
        yield from answers

    @property
    def state(self) -> dict[str, Any]:
        """How the page plays."""
        return {
            "kind": "state",
            "live": self.live,
            "playing": self.playing,
            "speed": self.speed,
            "selected": self.selected,
            "end_s": round(self.history.end_s, 2),
        }

    def _play(self) -> None:
        if self.cursor_s >= self.history.end_s and not self.live:
            self._seek(0.0)
        self.playing = True

    def _seek(self, t_s: float) -> None:
        self.cursor_s = min(max(0.0, t_s), self.history.end_s)
        self.live, self._shown_s = False, None

    def _seek_move(self, robot: str, number: int) -> None:
        """To the end of a move; to the last one if there are not so many."""
        if robot in self.history.robots:
            learning = self.history.robots[robot].learning
            t_s = learning.time_of_move(min(max(1, number), learning.last_number))
            self._seek(t_s or 0.0)

    def _frame(self) -> dict[str, Any]:
        jumped = self._shown_s is None or self.cursor_s < self._shown_s
        since_s = self.cursor_s - TRAIL_S if jumped else self._shown_s or 0.0
        self._shown_s, self._heard = self.cursor_s, self.history.messages
        return {**frame(self.history, self.cursor_s, since_s), "jumped": jumped}

    def _heard_more(self) -> bool:
        """Whether more was said of the newest moment, which is shown."""
        return self.cursor_s >= self.history.end_s and self._heard != self.history.messages

    def _learner(self) -> Iterator[dict[str, Any]]:
        """The selected robot's head, if a move, a path or another choice has changed it."""
        learning = self.history.robots[self.selected].learning
        paths = sum(path.t_s <= self.cursor_s for path in learning.paths)
        shown = (self.selected, learning.made(self.cursor_s), paths)
        if shown != self._shown_learner:
            self._shown_learner = shown
            yield learner_view(self.history, self.selected, self.cursor_s)

    def _growth(self) -> dict[str, Any] | None:
        """What has been heard since the page was last told, wherever it stands: curves, events, visits."""
        curves = {
            name: [[round(t_s, 1), move, length] for t_s, move, length in new]
            for name, robot in self.history.robots.items()
            if (new := self._new(name, "best path", robot.learning.best_paths))
        }
        visits = {
            name: [[round(visit.t_s, 1), visit.visit, visit.phase, visit.path, visit.reason] for visit in new]
            for name, robot in self.history.robots.items()
            if (new := self._new(name, "visit", robot.visits))
        }
        events = [
            [round(event.t_s, 1), event.level, event.who, event.name, event.text]
            for event in self._new("", "event", self.history.events)
        ]
        if not (curves or visits or events):
            return None
        return {"kind": "growth", "curves": curves, "visits": visits, "events": events}

    def _new(self, name: str, what: str, entries: list[Any]) -> list[Any]:
        told = self._told[name, what]
        new = entries[told : told + MOST_AT_ONCE]
        self._told[name, what] += len(new)
        return new
