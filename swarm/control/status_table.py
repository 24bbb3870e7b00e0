"""How a run goes, for a terminal: its state, a line for each robot, what a hand is wanted for, the news."""

from __future__ import annotations

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from swarm.messages import swarm_pb2 as pb

NEWS_SHOWN = 6
"""Lines: beside ten robots they fit a terminal of 24."""
OLD_POSE_S = 1.0
"""At this age of its pose a robot stands."""
SILENT_S = 3.0
"""Three status messages."""
LOW_BATTERY_V = 3.4
"""An e-puck's battery, a lithium cell of 3.7 V, is nearly empty there."""
NEVER_S = 1e5
"""What has never been heard is said to be so old."""
COLOURS = {
    pb.RunState.RUNNING: "green",
    pb.RunState.PAUSED: "yellow",
    pb.RunState.ESTOPPED: "bold white on red",
}
LEVELS = {pb.Event.WARNING: "yellow", pb.Event.ERROR: "red"}


def status_table(status: pb.RunStatus) -> RenderableType:
    """Everything on one screen."""
    parts: list[RenderableType] = [_headline(status)]
    if status.missing:
        parts.append(Text(f"waiting for {', '.join(status.missing)}", style="yellow"))
    parts.append(_robots(status))
    parts += [
        Text(f"prompt {prompt.number}: {prompt.text} (swarm done {prompt.number})", style="bold yellow")
        for prompt in status.prompts
    ]
    parts += [_news(event, status.t_ns) for event in status.events[-NEWS_SHOWN:]]
    return Group(*parts)


def _headline(status: pb.RunStatus) -> Text:
    phase = pb.RunState.Phase.Name(status.phase).lower()
    line = Text(f"{status.experiment} trial {status.trial}: ")
    line.append(phase, style=COLOURS.get(status.phase, ""))
    if status.reason:
        line.append(f", {status.reason}")
    left = f", about {_duration(status.time_left_s)} left" if status.time_left_s else ""
    return line.append(f"; {_duration(status.elapsed_s)} so far{left}")


def _robots(status: pb.RunStatus) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("robot", "condition", "activity"):
        table.add_column(name)
    for name in ("moves", "path", "battery", "pose", "link"):
        table.add_column(name, justify="right")
    for robot in status.robots:
        table.add_row(
            robot.robot,
            robot.condition,
            _activity(robot),
            f"{robot.moves}/{status.moves_wanted}" if robot.role == "learner" else f"{robot.moves}",
            f"{robot.best_path or '-'}",
            _battery(robot.battery_v),
            _age(robot.pose_age_s, OLD_POSE_S),
            _link(robot),
        )
    return table


def _activity(robot: pb.RobotStatus) -> Text:
    if robot.estopped:
        return Text("estopped", style="bold white on red")
    paused = Text(" (paused)", style="yellow") if robot.paused else Text("")
    return Text(robot.activity or "-") + paused


def _battery(battery_v: float) -> Text:
    if not battery_v:
        return Text("-")
    return Text(f"{battery_v:.2f} V", style="red" if battery_v < LOW_BATTERY_V else "")


def _age(age_s: float, old_s: float) -> Text:
    if age_s >= NEVER_S:
        return Text("never", style="red")
    return Text(f"{age_s:.1f} s old", style="red" if age_s > old_s else "")


def _link(robot: pb.RobotStatus) -> Text:
    if not robot.present:
        return Text("gone", style="red")
    if robot.heard_age_s > SILENT_S:
        return Text("silent ") + _age(robot.heard_age_s, SILENT_S)
    return Text(f"{robot.messages_per_s:.0f}/s")


def _news(event: pb.RecentEvent, now_ns: int) -> Text:
    ago = _duration((now_ns - event.t_ns) * 1e-9)
    text = f"{ago:>7} ago  {event.sender} {event.name}: {event.text}"
    return Text(text, style=LEVELS.get(event.level, ""), overflow="ellipsis", no_wrap=True)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = seconds / 60
    return f"{minutes:.0f} min" if minutes < 100 else f"{minutes / 60:.1f} h"
