"""`swarm pause`, `resume`, `stop`, `estop` and `done`: what a person tells a live run to do."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.steering import At, Credentials, Json, steering
from swarm.errors import RunFailedError, UserError
from swarm.runtime.endpoint import DEFAULT_ENDPOINT

Robots = Annotated[list[str] | None, typer.Argument(metavar="[ROBOT...]", help="These only; else all.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="Why: it stands in the log.")]


def pause_command(
    robot: Robots = None,
    at: At = DEFAULT_ENDPOINT,
    reason: Reason = "",
    zenoh_config: Credentials = None,
    json: Json = False,
) -> None:
    """Have the robots finish what is under way and stand, for instance to change a battery."""
    _give("PAUSE", at, zenoh_config, json, robots=robot or [], reason=reason)


def resume_command(
    robot: Robots = None,
    at: At = DEFAULT_ENDPOINT,
    reason: Reason = "",
    zenoh_config: Credentials = None,
    json: Json = False,
) -> None:
    """Have the robots go on after a pause."""
    _give("RESUME", at, zenoh_config, json, robots=robot or [], reason=reason)


def stop_command(
    at: At = DEFAULT_ENDPOINT,
    reason: Reason = "",
    zenoh_config: Credentials = None,
    json: Json = False,
) -> None:
    """End the trial now, in order: the robots stop, and the log is closed."""
    _give("STOP", at, zenoh_config, json, reason=reason)


def estop_command(
    release: Annotated[bool, typer.Option("--release", help="The emergency is over.")] = False,
    at: At = DEFAULT_ENDPOINT,
    reason: Reason = "",
    zenoh_config: Credentials = None,
    json: Json = False,
) -> None:
    """Stop every wheel at once and keep it so, over restarts too, until `swarm estop --release`.

    After the release the run is paused: `swarm resume` lets it go on.
    """
    if release:
        _give("RELEASE", at, zenoh_config, json, reason=reason)
        return
    try:
        _give("ESTOP", at, zenoh_config, json, reason=reason)
    except UserError as error:
        raise RunFailedError(f"{error} THE ROBOTS MAY NOT HAVE HEARD IT: switch them off by hand") from error


def done_command(
    prompt: Annotated[int, typer.Argument(min=1, help="Its number, as `swarm status` shows it.")],
    at: At = DEFAULT_ENDPOINT,
    zenoh_config: Credentials = None,
    json: Json = False,
) -> None:
    """Say that what a prompt asked for is done; refused if the robot's own pose shows that it is not."""
    _give("DONE", at, zenoh_config, json, prompt=prompt)


def _give(
    kind: str,
    at: str,
    config: Path | None,
    as_json: bool,
    *,
    robots: list[str] | None = None,
    reason: str = "",
    prompt: int = 0,
) -> None:
    """Give the order; RunFailedError if it is refused."""
    from swarm.messages import swarm_pb2 as pb
    from swarm.runtime.operating import operator_name, send_order

    order = pb.OperatorOrder(
        kind=pb.OperatorOrder.Kind.Value(kind),
        operator=operator_name(),
        reason=reason,
        robots=robots or [],
        prompt=prompt,
    )
    with steering(at, config) as session:
        answer = send_order(session, order)
    if as_json:
        print_json({"accepted": answer.accepted, "text": answer.text})
    if not answer.accepted:
        raise RunFailedError(f"refused: {answer.text}")
    if not as_json:
        typer.echo(answer.text)
