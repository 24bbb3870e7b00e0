"""Where a run is that somebody wants to see or steer: at an endpoint, in its directory, in a laboratory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from swarm.access.identities import OPERATOR, VIEWER, Identity
from swarm.config.laboratory import Laboratory
from swarm.errors import UserError
from swarm.runtime.endpoint import PROTOCOLS
from swarm.runtime.zenoh_session import SessionSettings

ENDPOINT = "endpoint"
"""In a run's directory, while its server listens: where it does."""
KEYS = "keys"
"""Beside a laboratory file: the folder that `swarm lab keys` makes."""


def settings_of(
    where: str, config: Path | None = None, credentials: Path | None = None, *, insecure: bool = False
) -> SessionSettings:
    """How to reach the run at WHERE, with the operator's or else the viewer's keys beside a laboratory file.

    `config` are more of Zenoh's settings. UserError if nobody can be reached there, whoever listens.
    """
    if Path(where).suffix == ".toml" and credentials is None:
        credentials = next(_folders(Path(where), (OPERATOR, VIEWER)), None)
    endpoint = endpoint_of(where, "tls" if credentials else "tcp")
    return SessionSettings(
        endpoint, wait_for_hub=False, config=config, credentials=credentials, insecure=insecure
    )


def keys_of(laboratory: Path, identity: Identity) -> Path | None:
    """The folder of an identity's keys beside a laboratory file; None if there is none."""
    return next(_folders(laboratory, (identity,)), None)


def endpoint_of(where: str, protocol: str = "tcp") -> str:
    """The endpoint of a run, from an endpoint, a run's directory or a laboratory file."""
    if where.partition("/")[0] in (*PROTOCOLS, "unixsock-stream"):
        return where
    path = Path(where)
    if path.is_dir():
        return _endpoint_in(path)
    if path.suffix == ".toml":
        return f"{protocol}/{Laboratory.load(path).server_address}"
    raise UserError(f"{where}: is no endpoint (tls/HOST:PORT), no run's directory and no laboratory file")


def _folders(laboratory: Path, identities: Sequence[Identity]) -> Iterator[Path]:
    folders = (laboratory.parent / KEYS / str(identity) for identity in identities)
    return (folder for folder in folders if folder.is_dir())


def _endpoint_in(run: Path) -> str:
    try:
        endpoint = (run / ENDPOINT).read_text(encoding="utf-8").strip()
    except FileNotFoundError as error:
        raise UserError(
            f"{run}: nobody listens there: the run is over, or it is a simulation without --speed X"
        ) from error
    except (OSError, UnicodeError) as error:
        raise UserError(f"{run / ENDPOINT}: cannot be read ({error})") from error
    return endpoint.replace("/0.0.0.0:", "/127.0.0.1:")  # The directory is on the server's machine.
