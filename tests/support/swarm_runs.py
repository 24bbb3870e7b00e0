"""Small simulated runs for tests: experiment files, and the server as a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.reader import make_reader

from swarm.messages.topics import topic_of

ROOT = Path(__file__).parents[2]
COMPARTMENT_PITCH_M = 1.3
GIVEN_PATH = ("SE",) * 5

Robot = tuple[str, str, bool]
"""Id, role, and whether it is given the path of five SE moves."""

THREE_ROBOTS: tuple[Robot, ...] = (
    ("expert", "expert", False),
    ("imitator", "learner", True),
    ("loner", "learner", False),
)


def experiment_text(robots: tuple[Robot, ...] = THREE_ROBOTS, moves: int = 30, extra: str = "") -> str:
    """An experiment file with the robots' compartments in rows of ten."""
    rows = -(-len(robots) // 10)
    lines = ["[run]", 'name = "small"', f"moves = {moves}", "[arena]", "width_m = 13.0"]
    lines += [f"height_m = {rows * COMPARTMENT_PITCH_M:.1f}", extra]
    for number, (name, role, given) in enumerate(robots):
        row, column = divmod(number, 10)
        corner = f"[{column * COMPARTMENT_PITCH_M:.1f}, {row * COMPARTMENT_PITCH_M:.1f}]"
        lines += ["[[robot]]", f'id = "{name}"', f'role = "{role}"', f"south_west_m = {corner}"]
        if given:
            lines += ['condition = "given"', f"paths = {json.dumps([GIVEN_PATH])}"]
    return "\n".join(lines) + "\n"


def learners(count: int, *, given: bool = False) -> tuple[Robot, ...]:
    """So many learners, all with the path or all without."""
    return tuple((f"r{number}", "learner", given) for number in range(count))


def write_experiment(directory: Path, text: str) -> Path:
    """The experiment file in a directory of its own."""
    directory.mkdir(parents=True, exist_ok=True)
    file = directory / "small.toml"
    file.write_text(text, encoding="utf-8")
    return file


def server_command(experiment: Path, out: Path, *options: str) -> list[str]:
    """The command line of `swarm-server`."""
    return [sys.executable, "-m", "server", str(experiment), "--out", str(out), "--json", *options]


def run_server(experiment: Path, out: Path, *options: str) -> dict[str, Any]:
    """A whole run; what `--json` printed."""
    done = subprocess.run(
        server_command(experiment, out, *options), cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result


def messages(log: Path, kind: str) -> Iterator[tuple[str, Any]]:
    """Robot and decoded message for every message in a closed log whose key ends in `kind`."""
    with log.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            found = topic_of(channel.topic)
            if found and channel.topic.endswith(f"/{kind}"):
                yield found[1], found[0].message.FromString(message.data)
