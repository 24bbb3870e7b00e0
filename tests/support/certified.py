"""A laboratory with certificates, and plain sessions of Zenoh's for whoever holds one."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import zenoh

from swarm.access.credentials import zenoh_values
from swarm.access.keyring import Issued, Keyring
from swarm.access.zenoh_limits import hub_limits
from swarm.config.laboratory import Laboratory
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint

NOW = datetime(2026, 11, 26, tzinfo=UTC)


class CertifiedLaboratory:
    """The keys of a laboratory on this machine; `r0` has a certificate that was taken away, too."""

    def __init__(self, folder: Path, robots: Sequence[str] = ("r0", "r1"), simulated: bool = True) -> None:
        self.folder = folder
        self.robots = robots
        self.simulated = simulated
        self.endpoint = free_endpoint().replace("tcp/", "tls/")
        self.file = folder / "lab.toml"
        self.file.write_text(laboratory_text(robots), encoding="utf-8")
        self.update()
        shutil.copytree(self.keys("robot-r0"), self.keys("revoked"))
        self.update(renew=("robot-r0",))

    def keys(self, identity: str) -> Path:
        return self.folder / "keys" / identity

    def update(self, renew: Sequence[str] = (), revoke: Sequence[str] = ()) -> list[Issued]:
        keyring = Keyring(self.folder / "keys", Laboratory.load(self.file), self.simulated)
        return keyring.update(renew, revoke, NOW)

    def settings(self, identity: str, **more: Any) -> SessionSettings:
        return SessionSettings(self.endpoint, credentials=self.keys(identity), **more)

    def hub(self) -> Session:
        """The hub of a server, as `swarm-server` opens it."""
        return Session(self.settings("server", hub=True, limits=hub_limits(self.robots)))

    def client(self, identity: str) -> zenoh.Session:
        """A session of Zenoh's own; without certificate if the identity is empty."""
        config = zenoh.Config()
        values: Mapping[str, Any] = {
            "mode": "client",
            "connect/endpoints": [self.endpoint],
            "connect/timeout_ms": 0,
            "scouting/multicast/enabled": False,
            "transport/shared_memory/enabled": False,
            **self._shown(identity),
        }
        for key, value in values.items():
            config.insert_json5(key, json.dumps(value))
        return zenoh.open(config)

    def _shown(self, identity: str) -> dict[str, Any]:
        if identity:
            return zenoh_values(self.keys(identity), hub=False)
        return {"transport/link/tls/root_ca_certificate": str(self.keys("viewer") / "authority.pem")}


def laboratory_text(robots: Sequence[str], driver: str = "serial") -> str:
    """A laboratory file of robots on this machine."""
    here = 'host = "127.0.0.1"\n'
    tables = [
        f'[[robot]]\nid = "{robot}"\n{here}driver = "{driver}"\nsouth_west_m = [{1.5 * number}, 0.3]\n'
        for number, robot in enumerate(robots)
    ]
    return f'[laboratory]\nname = "here"\n[server]\n{here}' + "".join(tables)
