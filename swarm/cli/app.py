"""The verbs of the `swarm` command, as typer sees them."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from swarm.cli.analyze import analyze_command
from swarm.cli.check import check_command
from swarm.cli.claims import claims_command
from swarm.cli.compare import compare_command
from swarm.cli.console import console_command
from swarm.cli.deploy import deploy_command
from swarm.cli.doctor import doctor_command
from swarm.cli.durations import durations_command
from swarm.cli.export import export_command
from swarm.cli.film import film_command
from swarm.cli.info import info_command
from swarm.cli.lab import lab_app
from swarm.cli.orders import done_command, estop_command, pause_command, resume_command, stop_command
from swarm.cli.recover import recover_command
from swarm.cli.replay import replay_command
from swarm.cli.reproduce import reproduce_command
from swarm.cli.run import run_command
from swarm.cli.runs import runs_command
from swarm.cli.simulate import simulate_command
from swarm.cli.status import status_command
from swarm.cli.trials import trials_command
from swarm.cli.verify import verify_command
from swarm.cli.watch import watch_command
from swarm.errors import UserError
from swarm.version import version_text

app = typer.Typer(
    name="swarm",
    help="Learning experiments on a swarm of robots: simulate, reproduce, analyze.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(version_text())
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and leave."),
    ] = False,
) -> None:
    """What belongs to no verb."""


app.command("doctor")(doctor_command)
app.command("simulate")(simulate_command)
app.command("run")(run_command)
app.command("status")(status_command)
app.command("pause")(pause_command)
app.command("resume")(resume_command)
app.command("stop")(stop_command)
app.command("estop")(estop_command)
app.command("done")(done_command)
app.command("reproduce")(reproduce_command)
app.command("claims")(claims_command)
app.command("analyze")(analyze_command)
app.command("verify")(verify_command)
app.command("film")(film_command)
app.command("runs")(runs_command)
app.command("compare")(compare_command)
app.command("trials")(trials_command)
app.command("durations")(durations_command)
app.command("info")(info_command)
app.command("console")(console_command)
app.command("watch")(watch_command)
app.command("check")(check_command)
app.command("recover")(recover_command)
app.command("replay")(replay_command)
app.command("export")(export_command)
app.command("deploy")(deploy_command)
app.add_typer(lab_app, name="lab")


def _help_of(error: typer.TyperException) -> str:
    """The command whose help tells more: the verb's, if the error is about one."""
    context = getattr(error, "ctx", None)
    return f"{context.command_path if context else 'swarm'} --help"


def run() -> None:
    """Parse the command line and run the verb; a bad call becomes a UserError."""
    try:
        code = app(standalone_mode=False, prog_name="swarm")
    except typer.TyperException as error:
        what = " ".join(error.format_message().split()).rstrip(".") or "a verb is missing"
        raise UserError(f"{what} (see `{_help_of(error)}`)") from error
    except typer.Abort as error:
        raise KeyboardInterrupt from error
    sys.exit(code or 0)
