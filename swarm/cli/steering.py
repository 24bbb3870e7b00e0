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
    str, typer.Option(metavar="WHERE", help="tls/HOST:PORT, a run's directory, or a laboratory file.")
]
Keys = Annotated[
    Path | None,
    typer.Option(
        "--credentials", metavar="DIR", help="Your keys.", show_default="those beside a laboratory file"
    ),
]
Insecure = Annotated[bool, typer.Option("--insecure", help="Without keys, on a network of your own.")]
Json = Annotated[bool, typer.Option("--json", help="Print it as one JSON object.")]


@contextmanager
def steering(at: str, keys: Path | None, insecure: bool) -> Iterator[Session]:
    """A session with the run's server."""
    from swarm.control.reaching import settings_of
    from swarm.runtime.zenoh_session import Session

    with Session(settings_of(at, credentials=keys, insecure=insecure)) as session:
        yield session
