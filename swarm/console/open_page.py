"""What one open page is told of a run, and what it asks."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from swarm.console.controls import ORDERS, Answer, Controls
from swarm.console.polling import Polling
from swarm.console.sources import Source
from swarm.console.viewer import Viewer

FRAME_S = 0.05
"""The page draws the places in between; a trial's poses come every 0.1 s."""
FRAME_OF_MANY_S = 0.1
MANY_ROBOTS = 20
"""Above this a frame takes the page longer to draw than to show."""
STATE_S = 0.5
"""A person sees no difference."""


@dataclass(frozen=True)
class Shown:
    """The run that a console shows, and its controls if it is live and can be reached."""

    run: Polling[Source]
    controls: Controls | None = None


class OpenPage:
    """One browser's page."""

    def __init__(self, shown: Shown, *, may_steer: bool) -> None:
        self.may_steer = may_steer and shown.controls is not None
        self._shown = shown
        self._viewer: Viewer | None = None
        self._now_s: float | None = None
        self._state_due_s = 0.0
        self._answers: list[Answer] = []

    @property
    def period_s(self) -> float:
        """Between two frames."""
        history = self._shown.run.polled.history
        return FRAME_OF_MANY_S if history and len(history.robots) > MANY_ROBOTS else FRAME_S

    def hear(self, words: Any) -> None:
        """Something that the page asks."""
        self._state_due_s = 0.0
        if self._viewer:
            with self._viewer.history.lock:
                self._viewer.asked(words)

    @staticmethod
    def is_order(words: Any) -> bool:
        return isinstance(words, dict) and words.get("ask") == "order"

    def order(self, words: dict[str, Any]) -> None:
        """Give an order, if this page may; it takes as long as the run's server needs to answer."""
        self._answers.append(self._answer(words))
        self._state_due_s = 0.0

    def _answer(self, words: dict[str, Any]) -> Answer:
        if not (self.may_steer and self._shown.controls):
            return Answer(False, "this page may look, not steer: open the address that `--steer` prints")
        match words:
            case {"order": str(kind), "robots": list(robots), "prompt": int(prompt)} if (
                kind in ORDERS and prompt >= 0 and all(isinstance(robot, str) for robot in robots)
            ):
                return self._shown.controls.order(kind, robots, prompt)
        return Answer(False, "not an order")

    def messages(self, now_s: float) -> Iterator[str]:
        """What the page has to be told at a time, as JSON."""
        elapsed_s = now_s - self._now_s if self._now_s is not None else 0.0
        self._now_s = now_s
        viewer = self._viewer_of_run()
        for message in viewer.step(elapsed_s) if viewer else ():
            yield _packed(message)
        if now_s >= self._state_due_s:
            self._state_due_s = now_s + STATE_S
            yield _packed({**(viewer.state if viewer else {}), **self._about_source(), "kind": "state"})
        while self._answers:
            yield _packed({"kind": "answer", **self._answers.pop(0)._asdict()})

    def _viewer_of_run(self) -> Viewer | None:
        """A new one when another run has begun."""
        source = self._shown.run.polled
        history = source.history
        if history and (self._viewer is None or self._viewer.history is not history):
            self._viewer = Viewer(history, live=source.is_live)
        return self._viewer

    def _about_source(self) -> dict[str, Any]:
        source = self._shown.run.polled
        return {
            "source": self._shown.run.trouble or source.state,
            "trouble": bool(self._shown.run.trouble),
            "is_live": source.is_live,
            "may_steer": self.may_steer,
            "controls": self._shown.controls.status if self._shown.controls else None,
        }


def _packed(message: dict[str, Any]) -> str:
    return json.dumps(message, separators=(",", ":"))
