"""`robot-agent collect-copies`: pairs of true and copied lists, from rendered frames, for `swarm trials`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from robot_agent.offline.observation_session import (
    KINDS,
    ObservedDemonstration,
    observed_demonstrations,
    offline_experiment,
)
from swarm.config.experiment import CopyProfile
from swarm.errors import UserError
from swarm.geometry import Move
from swarm.runtime.process import OneLineParser
from swarm.surrogate.copies import CopyPair, write_copies


def collect(arguments: argparse.Namespace) -> None:
    """Show and copy demonstrations, and store what was shown and what was copied."""
    if arguments.demonstrations < 1:
        raise UserError(f"--demonstrations {arguments.demonstrations}: give at least 1")
    if arguments.out.exists():
        raise UserError(f"{arguments.out} is there already: choose another name or remove it")
    pairs = list(_pairs(arguments))
    write_copies(pairs, arguments.out, _told(arguments))
    wrong = sum(pair.true != pair.copied for pair in pairs)
    print(f"wrote {arguments.out}: {len(pairs)} pairs, {wrong} of them not the same")


def _pairs(arguments: argparse.Namespace) -> Iterator[CopyPair]:
    experiment = offline_experiment(CopyProfile(arguments.profile), arguments.light)
    for kind in KINDS:
        many = observed_demonstrations(experiment, kind, arguments.demonstrations, arguments.seed)
        for number, observed in enumerate(many, 1):
            _show(kind, number, arguments.demonstrations)
            yield _pair(kind, observed)


def _pair(kind: str, observed: ObservedDemonstration) -> CopyPair:
    return CopyPair(kind, observed.demonstration.moves, tuple(map(Move, observed.copied_moves)))


def _told(arguments: argparse.Namespace) -> list[str]:
    return [
        "true and copied lists of moves of the rendered pipeline; an empty copy was refused",
        f"made by: robot-agent collect-copies --demonstrations {arguments.demonstrations} "
        f"--profile {arguments.profile} --light {arguments.light} --seed {arguments.seed}",
    ]


def _show(kind: str, number: int, count: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{kind}: {number} of {count}", end="\n" if number == count else "", file=sys.stderr)


def collect_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent collect-copies",
        description="Let simulated robots show moves to each other, render what the observer's camera sees, "
        "and store what it copies. Takes about half a second a demonstration.",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.csv", help="a new file")
    parser.add_argument(
        "--demonstrations", type=int, default=300, metavar="N", help="of each kind (%(default)s)"
    )
    profiles = [profile.value for profile in CopyProfile]
    parser.add_argument("--profile", choices=profiles, default="best", help="how it copies (%(default)s)")
    parser.add_argument("--light", default="realistic", help="realistic, hard, dark or clean (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    return parser
