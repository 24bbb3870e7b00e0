"""`swarm pause`, `resume`, `stop`, `estop` and `done`: what a person tells a live run to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.steering import At, Insecure, Json, Keys, steering
from swarm.errors import RunFailedError, UserError
from swarm.runtime.endpoint import DEFAULT_ENDPOINT

Robots = Annotated[list[str] | None, typer.Argument(metavar="[ROBOT...]", help="These only; else all.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="Why: it stands in the log.")]


def _for_robots(kind: str, meaning: str) -> Callable[..., None]:
    """The verb of an order for all robots or for some."""

    def command(
        robot: Robots = None,
        at: At = DEFAULT_ENDPOINT,
        keys: Keys = None,
        insecure: Insecure = False,
        reason: Reason = "",
        json: Json = False,
    ) -> None:
        order = Order(kind, robots=tuple(robot or ()), reason=reason)
        _give(order, Server(at, keys, insecure), as_json=json)

    command.__doc__ = meaning
    return command


pause_command = _for_robots(
    "PAUSE", "Have the robots finish what is under way and stand, for instance to change a battery."
)
resume_command = _for_robots("RESUME", "Have the robots go on after a pause.")


def stop_command(
    reason: Reason = "",
    at: At = DEFAULT_ENDPOINT,
    keys: Keys = None,
    insecure: Insecure = False,
    json: Json = False,
) -> None:
    """End the trial now, in order: the robots stop, and the log is closed."""
    _give(Order("STOP", reason=reason), Server(at, keys, insecure), as_json=json)


def estop_command(
    release: Annotated[bool, typer.Option("--release", help="The emergency is over.")] = False,
    keys: Keys = None,
    insecure: Insecure = False,
    at: At = DEFAULT_ENDPOINT,
    reason: Reason = "",
    json: Json = False,
) -> None:
    """Stop every wheel at once and keep it so, over restarts too, until `swarm estop --release`.

    After the release the run is paused: `swarm resume` lets it go on.
    """
    server = Server(at, keys, insecure)
    if release:
        _give(Order("RELEASE", reason=reason), server, as_json=json)
        return
    try:
        _give(Order("ESTOP", reason=reason), server, as_json=json)
    except UserError as error:
        raise RunFailedError(f"{error} THE ROBOTS MAY NOT HAVE HEARD IT: switch them off by hand") from error


def done_command(
    prompt: Annotated[int, typer.Argument(min=1, help="Its number, as `swarm status` shows it.")],
    insecure: Insecure = False,
    at: At = DEFAULT_ENDPOINT,
    keys: Keys = None,
    json: Json = False,
) -> None:
    """Say that what a prompt asked for is done; refused if the robot's own pose shows that it is not."""
    _give(Order("DONE", prompt=prompt), Server(at, keys, insecure), as_json=json)


@dataclass(frozen=True)
class Order:
    """What a command line orders."""

    kind: str
    robots: tuple[str, ...] = ()
    reason: str = ""
    prompt: int = 0


@dataclass(frozen=True)
class Server:
    """Where a command line finds the run's server, and how it shows who gives the order."""

    at: str
    keys: Path | None
    insecure: bool


def _give(asked: Order, server: Server, *, as_json: bool) -> None:
    """Give the order; RunFailedError if it is refused."""
    from swarm.messages import swarm_pb2 as pb
    from swarm.runtime.operating import operator_name, send_order

    order = pb.OperatorOrder(
        kind=pb.OperatorOrder.Kind.Value(asked.kind),
        operator=operator_name(),
        reason=asked.reason,
        robots=asked.robots,
        prompt=asked.prompt,
    )
    with steering(server.at, server.keys, server.insecure) as session:
        answer = send_order(session, order)
    if as_json:
        print_json({"accepted": answer.accepted, "text": answer.text})
    if not answer.accepted:
        raise RunFailedError(f"refused: {answer.text}")
    if not as_json:
        typer.echo(answer.text)
