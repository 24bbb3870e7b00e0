"""`swarm deploy`: bring a laboratory's machines to what its file says."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.lab import KEYS_FOLDER, Json, LaboratoryFile
from swarm.cli.output import print_json, print_table
from swarm.errors import RunFailedError, UserError
from swarm.extras import require_extra

if TYPE_CHECKING:
    from swarm.deployment.visit import Outcome

WHEELHOUSE = "wheelhouse"

ExperimentFile = Annotated[
    Path | None,
    typer.Argument(help="What is to run there.", show_default="what every machine has already"),
]
Run = Annotated[bool, typer.Option("--run", help="Start the server as a service too: the run begins.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Only say what would change.")]
Rollback = Annotated[bool, typer.Option("--rollback", help="Go back to the release before.")]
Insecure = Annotated[bool, typer.Option("--insecure", help="Without certificates, on a network of your own.")]
Interrupt = Annotated[bool, typer.Option("--interrupt", help="End a run that is under way.")]
WheelhouseFolder = Annotated[
    Path | None,
    typer.Option(help="Where wheels are kept.", show_default=f"{WHEELHOUSE} beside the laboratory file"),
]


def deploy_command(
    laboratory: LaboratoryFile,
    experiment: ExperimentFile = None,
    run: Run = False,
    dry_run: DryRun = False,
    rollback: Rollback = False,
    insecure: Insecure = False,
    interrupt: Interrupt = False,
    wheelhouse: WheelhouseFolder = None,
    json: Json = False,
) -> None:
    """Install the program on all machines of a laboratory and start agents and tracker bridge, over SSH.

    Machines need no internet: wheels are fetched here once for each kind of machine, and copied. What does
    not become ready gives way to the release before. Exit code 0: every machine is as it should be; 1: not.
    """
    require_extra("deploy", "asyncssh", "packaging")
    from swarm.config.laboratory import Laboratory
    from swarm.deployment.deploy import deploy, roll_back
    from swarm.deployment.plan import Planner
    from swarm.deployment.release import ExperimentFiles, Protection
    from swarm.deployment.visit import State
    from swarm.deployment.wheels import Wheelhouse
    from swarm.runtime.versions import versions

    lab = Laboratory.load(laboratory)
    if rollback:
        if experiment or dry_run:
            raise UserError("--rollback goes back to what was there: leave EXPERIMENT and --dry-run out")
        outcomes = roll_back(lab, _tell, interrupt=interrupt)
    else:
        if run and not experiment:
            raise UserError("--run begins an experiment: say which")
        _check(laboratory, experiment)
        planner = Planner(
            lab,
            Wheelhouse(wheelhouse or laboratory.parent / WHEELHOUSE),
            lab.versions.program or versions()["program"],
            ExperimentFiles.read(experiment) if experiment else None,
            Protection.of(laboratory.parent / KEYS_FOLDER, insecure),
            run=run,
        )
        outcomes = deploy(lab, planner, _tell, dry_run=dry_run, interrupt=interrupt)
    if json:
        print_json({"laboratory": str(laboratory), "machines": [outcome.as_json() for outcome in outcomes]})
    else:
        print_table(("machine", "", "release", "what"), [_row(outcome) for outcome in outcomes])
    failed = [outcome.name for outcome in outcomes if outcome.state is State.FAILED]
    if failed:
        raise RunFailedError(f"{len(failed)} of {len(outcomes)} machines failed: {'; '.join(failed)}")


def _check(laboratory: Path, experiment: Path | None) -> None:
    """UserError about what `swarm lab check` finds bad."""
    from swarm.checkup.finding import require_good
    from swarm.checkup.laboratory import fit_findings, laboratory_findings
    from swarm.config.experiment import Experiment
    from swarm.config.laboratory import Laboratory

    lab = Laboratory.load(laboratory)
    require_good(laboratory, laboratory_findings(lab))
    if experiment:
        require_good(laboratory, fit_findings(lab, Experiment.load(experiment)))


def _row(outcome: Outcome) -> tuple[str, str, str, str]:
    services = [f"{name.removesuffix('.service')} {state}" for name, state in outcome.services.items()]
    what = outcome.reason or ", ".join(services) or "no service: it has no experiment yet"
    if outcome.state == "would change":
        what = f"{', '.join(outcome.changes)}; {len(outcome.copied)} wheels to copy"
    return outcome.name, outcome.state.value, outcome.release, what


def _tell(machine: str, step: str) -> None:
    print(f"{machine}: {step}", file=sys.stderr, flush=True)
