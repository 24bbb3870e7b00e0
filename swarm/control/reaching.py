"""Where a run is that somebody wants to see or steer: at an endpoint, in its directory, in a laboratory."""

from __future__ import annotations

from pathlib import Path

from swarm.config.laboratory import Laboratory
from swarm.errors import UserError
from swarm.runtime.endpoint import PROTOCOLS
from swarm.runtime.zenoh_session import SessionSettings

ENDPOINT = "endpoint"
"""In a run's directory, while its server listens: where it does."""


def settings_of(where: str, config: Path | None = None) -> SessionSettings:
    """How to reach the run at WHERE; `config` is a Zenoh configuration with the operator's credentials.

    UserError if nobody can be reached there, whoever listens.
    """
    return SessionSettings(endpoint_of(where), wait_for_hub=False, config=config)


def endpoint_of(where: str) -> str:
    """The endpoint of a run, from an endpoint, a run's directory or a laboratory file."""
    if where.partition("/")[0] in (*PROTOCOLS, "unixsock-stream"):
        return where
    path = Path(where)
    if path.is_dir():
        return _endpoint_in(path)
    if path.suffix == ".toml":
        return f"tcp/{Laboratory.load(path).server_address}"
    raise UserError(
        f"{where}: is no endpoint such as tcp/HOST:PORT, no run's directory and no laboratory file"
    )


def _endpoint_in(run: Path) -> str:
    try:
        return (run / ENDPOINT).read_text(encoding="utf-8").strip()
    except FileNotFoundError as error:
        raise UserError(
            f"{run}: nobody listens there: the run is over, or it is a simulation without --speed X"
        ) from error
    except (OSError, UnicodeError) as error:
        raise UserError(f"{run / ENDPOINT}: cannot be read ({error})") from error
