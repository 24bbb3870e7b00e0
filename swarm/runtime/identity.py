"""Whose run is this? What must be the same in everyone who takes part, and how a difference is told.

A run's id tells two runs of one experiment apart; digests tell experiments, seeds, trials and message schemas
apart. The server answers the key `RUN_IDENTITY` with all settings, so that who differs can say where.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property
from typing import Any

from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb

DIGEST_BYTES = 8
"""Two of a laboratory's experiments have the same digest once in 10^19 pairs."""
MAX_BYTES = 1_048_576
"""Of the answer: a thousand robots fill a third of it."""
SAME_WHATEVER = "simulation.processes"
"""The one setting that changes nothing of what a run records."""
SHOWN = 6
"""Differences in one line; more are counted."""


def canonical(experiment: Experiment) -> dict[str, str]:
    """Every setting as JSON, by `table.key` or `robot.ID.key`: the order of the file does not show."""
    tables: dict[str, Any] = {
        field.name: getattr(experiment, field.name)
        for field in dataclasses.fields(experiment)
        if field.name != "robot"
    } | {f"robot.{robot.id}": robot for robot in experiment.robot}
    settings = {
        f"{table}.{key}": _json(value)
        for table, group in tables.items()
        for key, value in vars(group).items()
    }
    settings.pop(SAME_WHATEVER)
    return dict(sorted(settings.items()))


def _json(value: Any) -> str:
    return json.dumps(value.value if isinstance(value, Enum) else value)


@dataclass(frozen=True)
class Fingerprint:
    """An identity in short: in presence, run state, checkpoint and log. `str` and `parse` are inverses."""

    experiment: str
    """Digest of all settings but the seed."""
    seed: int
    trial: int
    schema: str
    """Digest of the message types."""

    def __str__(self) -> str:
        return f"{self.experiment}-{self.seed}-{self.trial}-{self.schema}"

    @classmethod
    def parse(cls, text: str) -> Fingerprint:
        """ValueError if the text is no fingerprint."""
        experiment, seed, trial, schema = text.split("-")
        return cls(experiment, int(seed), int(trial), schema)

    def differences(self, other: Fingerprint) -> list[str]:
        """In words, from this one's side, what differs in the other."""
        found = []
        if self.schema != other.schema:
            found.append("its messages are of another version of the program")
        if self.experiment != other.experiment:
            found.append("its experiment has other settings")
        if self.seed != other.seed:
            found.append(f"its seed is {other.seed} and not {self.seed}")
        if self.trial != other.trial:
            found.append(f"its trial is {other.trial} and not {self.trial}")
        return found


@dataclass(frozen=True)
class RunIdentity:
    """Which trial of which experiment, and for the server which run."""

    settings: Mapping[str, str]
    trial: int
    schema: str
    run_id: str = ""
    """Empty where no run is known yet, and in a lockstep, which nobody can join."""
    program: str = ""
    """The server's version, for whoever does not fit it."""

    @classmethod
    def of(cls, experiment: Experiment, trial: int, run_id: str = "", program: str = "") -> RunIdentity:
        """The identity of a trial as this program would play it."""
        return cls(canonical(experiment), trial, schema_digest(), run_id, program)

    @cached_property
    def fingerprint(self) -> Fingerprint:
        settings = dict(self.settings)
        seed = int(settings.pop("run.seed"))
        return Fingerprint(_digest(json.dumps(settings).encode()), seed, self.trial, self.schema)

    def differences(self, other: RunIdentity) -> list[str]:
        """Every key that differs with both values, from this one's side; the messages' version first."""
        version = f"the messages are of another version of the program, there {other.program or 'unknown'}"
        found = [] if self.schema == other.schema else [version]
        found += _differing(self.settings, other.settings)
        if self.trial != other.trial:
            found.append(f"--trial is {self.trial} here and {other.trial} there")
        return found

    def pack(self) -> bytes:
        """As JSON, for the wire."""
        return json.dumps(dataclasses.asdict(self)).encode()

    @classmethod
    def unpack(cls, payload: bytes) -> RunIdentity:
        """ValueError if the bytes are no identity."""
        if len(payload) > MAX_BYTES:
            raise ValueError(f"an identity of {len(payload)} bytes")
        try:
            found = cls(**json.loads(payload))
            if all(isinstance(value, str) for value in found.settings.values()) and found.fingerprint:
                return found
        except (AttributeError, KeyError, RecursionError, TypeError) as error:
            raise ValueError("not an identity") from error
        raise ValueError("not an identity")


def _differing(here: Mapping[str, str], there: Mapping[str, str]) -> list[str]:
    """`key is A here and B there`; of a robot that one side does not name, only that."""
    found: dict[str, str] = {}
    for key in sorted(here.keys() | there.keys()):
        if key in here and key in there:
            if here[key] != there[key]:
                found[key] = f"{key} is {here[key]} here and {there[key]} there"
        else:
            table = key.rpartition(".")[0]
            found[table] = f"{table} is only {'here' if key in here else 'there'}"
    return list(found.values())


def shown(differences: Iterable[str]) -> str:
    """Differences in one line."""
    texts = list(differences)
    more = f", and {len(texts) - SHOWN} more" if len(texts) > SHOWN else ""
    return f"{', '.join(texts[:SHOWN])}{more}"


@cache
def schema_digest() -> str:
    """Of the message types of this program."""
    return _digest(pb.DESCRIPTOR.serialized_pb)


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=DIGEST_BYTES).hexdigest()
