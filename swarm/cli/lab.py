"""`swarm lab`: what is done with a laboratory file before anything moves."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_findings, print_json
from swarm.cli.values import good_place
from swarm.extras import require_extra

LABORATORY_FILE = "lab.toml"

lab_app = typer.Typer(help="A laboratory: its file, and whether it fits an experiment.", no_args_is_help=True)

KEYS_FOLDER = "keys"
"""Beside the laboratory file."""

LaboratoryFile = Annotated[Path, typer.Argument(help="A laboratory file, such as deploy/lab.toml.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")]


@lab_app.command("init")
def init_command(
    out: Annotated[Path, typer.Option(help="A folder, new or not.", callback=good_place)],
    json: Json = False,
) -> None:
    """Write a laboratory file with every setting and a comment to each; nothing is overwritten."""
    from swarm.files import make_folder, new_file

    make_folder(out)
    path = out / LABORATORY_FILE
    with new_file(path) as file:
        file.write(files("swarm.config").joinpath(LABORATORY_FILE).read_bytes())
    if json:
        print_json({"laboratory": str(path)})
    else:
        typer.echo(f"wrote {path}: say there which machines and robots there are")


@lab_app.command("check")
def check_command(
    laboratory: LaboratoryFile,
    experiment: Annotated[Path | None, typer.Argument(help="An experiment that is to run there.")] = None,
    reach: Annotated[
        bool, typer.Option("--reach", help="Ask every machine what it runs, and what time it has.")
    ] = False,
    json: Json = False,
) -> None:
    """Look at a laboratory file, and at whether an experiment fits its robots.

    Exit code 0: it does. 1: something is bad; the cure stands beside it. 2: a file is not what it should be.
    """
    from swarm.checkup.finding import any_bad
    from swarm.checkup.laboratory import fit_findings, laboratory_findings
    from swarm.config.experiment import Experiment
    from swarm.config.laboratory import Laboratory
    from swarm.runtime.versions import versions

    lab = Laboratory.load(laboratory)
    found = list(laboratory_findings(lab))
    if experiment:
        found += fit_findings(lab, Experiment.load(experiment))
    if reach:
        require_extra("deploy", "asyncssh", "packaging")
        from swarm.deployment.standing import standing_findings

        found += standing_findings(lab)
    if json:
        shown = [finding.as_json() for finding in found]
        print_json({"laboratory": str(laboratory), "versions": versions(), "findings": shown})
    else:
        print_findings(found)
    if any_bad(found):
        raise typer.Exit(1)


@lab_app.command("keys")
def keys_command(
    laboratory: LaboratoryFile,
    renew: Annotated[
        list[str] | None,
        typer.Option(
            help="Make a new certificate; the old one is worth nothing then. `all`: and a new authority."
        ),
    ] = None,
    revoke: Annotated[
        list[str] | None, typer.Option(help="Take a certificate away, until it is renewed.")
    ] = None,
    simulated: Annotated[
        bool,
        typer.Option("--simulated", help="Robots are simulated or emulated: they may tell where they are."),
    ] = False,
    json: Json = False,
) -> None:
    """Make a certificate for everyone in a laboratory and the rules of who may do what, in `keys` beside it.

    What is there is kept. Each process is given its own folder with --credentials, and nobody the folder
    `keys/authority`. Rules hold from the server's next start.
    """
    require_extra("lab", "cryptography")
    from datetime import UTC, datetime

    from swarm.access.keyring import Keyring
    from swarm.config.laboratory import Laboratory

    folder = laboratory.parent / KEYS_FOLDER
    keyring = Keyring(folder, Laboratory.load(laboratory), simulated)
    issued = keyring.update(renew or (), revoke or (), datetime.now(UTC))
    if json:
        print_json({"keys": str(folder), "identities": [vars(one) for one in issued]})
        return
    for one in issued:
        until = f", until {one.valid_until}" if one.valid_until else ""
        typer.echo(f"{one.state:<8} {folder / one.name}{until}")
