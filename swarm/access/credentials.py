"""The folder that an identity's process is given: its certificate, its key, and whom it believes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from swarm.errors import UserError

AUTHORITY_FILE = "authority.pem"
CERTIFICATE_FILE = "certificate.pem"
KEY_FILE = "key.pem"
ACCESS_FILE = "access.json"
"""Of the server alone: Zenoh's access rules."""


def zenoh_values(folder: Path, hub: bool) -> dict[str, Any]:
    """Zenoh's settings by their place in its configuration, to speak with these credentials.

    UserError if one of the files is not there.
    """
    wanted = (AUTHORITY_FILE, CERTIFICATE_FILE, KEY_FILE, *((ACCESS_FILE,) if hub else ()))
    for name in wanted:
        if not (folder / name).is_file():
            whose = "the server's are needed here" if name == ACCESS_FILE else "`swarm lab keys` makes them"
            raise UserError(f"--credentials {folder}: {name} is not there; {whose}")
    values: dict[str, Any] = {"transport/link/tls": tls(folder.resolve(), hub)}
    if hub:
        values["access_control"] = json.loads((folder / ACCESS_FILE).read_text(encoding="utf-8"))
    return values


def tls(folder: Path, hub: bool) -> dict[str, Any]:
    """Zenoh's `transport/link/tls`: both sides show a certificate of the same authority."""
    side = "listen" if hub else "connect"
    return {
        "root_ca_certificate": str(folder / AUTHORITY_FILE),
        "enable_mtls": True,
        f"{side}_certificate": str(folder / CERTIFICATE_FILE),
        f"{side}_private_key": str(folder / KEY_FILE),
        "verify_name_on_connect": True,
    }
