"""The verbs of the `swarm` command, as typer sees them."""

from __future__ import annotations

import sys

import typer

from swarm.cli.analyze import analyze_command
from swarm.cli.check import check_command
from swarm.cli.claims import claims_command
from swarm.cli.durations import durations_command
from swarm.cli.recover import recover_command
from swarm.cli.reproduce import reproduce_command
from swarm.cli.simulate import simulate_command
from swarm.cli.trials import trials_command
from swarm.errors import UserError

app = typer.Typer(
    name="swarm",
    help="Learning experiments on a swarm of robots: simulate, reproduce, analyze.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.callback()
def _root() -> None:
    """Keeps the verbs as sub-commands while there is only one."""


app.command("simulate")(simulate_command)
app.command("reproduce")(reproduce_command)
app.command("claims")(claims_command)
app.command("analyze")(analyze_command)
app.command("trials")(trials_command)
app.command("durations")(durations_command)
app.command("check")(check_command)
app.command("recover")(recover_command)


def run() -> None:
    """Parse the command line and run the verb; a bad call becomes a UserError."""
    try:
        code = app(standalone_mode=False)
    except typer.TyperException as error:
        what = " ".join(str(error).split()) or "a verb is missing"
        raise UserError(f"{what} (see `swarm --help`)") from error
    except typer.Abort as error:
        raise KeyboardInterrupt from error
    sys.exit(code or 0)
