"""A run in a terminal: the same history as the page's, as text."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from swarm.console.cures import CURES
from swarm.console.learner_view import thinned
from swarm.console.moment import frame
from swarm.console.robot_history import RobotHistory, place_at
from swarm.console.run_history import EventAt, RunHistory

NEWS_SHOWN = 5
"""Lines: beside ten robots they fit a terminal of 24."""
CURVE_WIDTH = 24
"""Letters of a learning curve."""
BARS = "▁▂▃▄▅▆▇█"
STALE_S = 1.0
"""A robot stands when its pose is older."""
PHASES = {"running": "green", "paused": "yellow", "estopped": "bold white on red", "ended": "bold"}
LEVELS = {"warning": "yellow", "error": "red"}


def run_table(history: RunHistory, state: str, t_s: float) -> RenderableType:
    """Everything on one screen, at a moment; `state` says how the source of the history does."""
    now = frame(history, t_s, t_s)
    events = history.events[: place_at(history.events, t_s)][-NEWS_SHOWN:]
    return Group(
        _headline(history, now), _robots(history, now), *map(_news, events), Text(state, style="dim")
    )


def _headline(history: RunHistory, now: dict[str, Any]) -> Text:
    run = history.experiment.run
    line = Text(f"{run.name} trial {history.about.trial}: ")
    line.append(now["phase"] or "waiting", style=PHASES.get(now["phase"], ""))
    line.append(f"; {clock(now['t_s'])} so far")
    if now["left_s"] is not None and now["phase"] != "ended":
        line.append(f", about {clock(now['left_s'])} left")
    return line


def _robots(history: RunHistory, now: dict[str, Any]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("robot", "condition", "doing"):
        table.add_column(name)
    for name in ("moves", "best path"):
        table.add_column(name, justify="right")
    table.add_column("learning")
    for name in ("paths", "pose", "poses/s", "battery", "lost"):
        table.add_column(name, justify="right")
    for name, robot in now["robots"].items():
        table.add_row(*_row(history, history.robots[name], robot, now["t_s"]))
    return table


def _row(history: RunHistory, robot: RobotHistory, now: dict[str, Any], t_s: float) -> list[Text]:
    age_s, settings = now["pose_age_s"], robot.settings
    stale = age_s is None or age_s > STALE_S
    lengths = [best.length for best in robot.learning.best_paths if best.t_s <= t_s]
    return [
        Text(settings.id, style="bold"),
        Text(settings.group),
        Text(_doing(now)),
        Text(f"{now['moves']:,}"),
        Text(str(now["best"] or "-")),
        Text(_curve(lengths, history.experiment.learning.path_length_cap), style="cyan"),
        Text(str(sum(path.t_s <= t_s for path in robot.learning.paths)) if settings.watches else "-"),
        Text("none" if age_s is None else f"{age_s:.1f} s", style="red" if stale else ""),
        Text(f"{now['rate_hz']:.1f}"),
        Text(f"{now['battery_v']:.2f} V" if now["battery_v"] else "-"),
        Text(str(now["lost"]), style="yellow" if now["lost"] else ""),
    ]


def _doing(now: dict[str, Any]) -> str:
    if now["visit"]:
        return f"watches {now['visit']['whom']}"
    return f"path {now['path']['number']}" if now["path"] else now["activity"] or "-"


def _curve(lengths: list[int], cap: int) -> str:
    """The best path's length over the moves so far, as bars of letters: low is good."""
    shares = [min(1.0, length / cap) for length in thinned(lengths, CURVE_WIDTH)]
    return "".join(BARS[round(share * (len(BARS) - 1))] for share in shares)


def _news(event: EventAt) -> Text:
    cure = CURES.get(event.name) if event.level != "info" else None
    line = Text(f"{clock(event.t_s):>8}  ", overflow="ellipsis", no_wrap=True)
    line.append(f"{event.who} {event.name}: {event.text}", style=LEVELS.get(event.level, ""))
    return line.append(f"  {cure}", style="dim") if cure else line


def clock(seconds: float) -> str:
    """1:02:03."""
    minutes, left_s = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{left_s:02}"
