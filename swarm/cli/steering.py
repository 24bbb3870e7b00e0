"""What the verbs that see or steer a live run share: where it is, and by whose credentials."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from swarm.runtime.zenoh_session import Session

At = Annotated[
    str, typer.Option(metavar="WHERE", help="tcp/HOST:PORT, a run's directory, or a laboratory file.")
]
Credentials = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Zenoh settings with the operator's certificate.")
]
Json = Annotated[bool, typer.Option("--json", help="Print it as one JSON object.")]


@contextmanager
def steering(at: str, config: Path | None) -> Iterator[Session]:
    """A session with the run's server."""
    from swarm.control.reaching import settings_of
    from swarm.runtime.zenoh_session import Session

    with Session(settings_of(at, config)) as session:
        yield session
