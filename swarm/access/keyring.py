"""A laboratory's keys on the disk: a folder for each identity, and the server's rules about them all.

    keys/
      authority/    signs the others; it stays where it was made
      server/       its certificate and key, the access rules, and a router's configuration
      robot-r1/     what the process on this robot's board is given
      ...
      revoked.json  whose certificate was taken away

The rules know a certificate by its common name, which has a number of its own. Who is not listed may do
nothing: a certificate that was renewed, revoked, or is of a robot that the laboratory no longer has.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from swarm.access.authority import Authority, Signed, common_name, hosts_of, valid_until
from swarm.access.credentials import ACCESS_FILE, AUTHORITY_FILE, CERTIFICATE_FILE, KEY_FILE, tls
from swarm.access.identities import SERVER, Identity, identities
from swarm.access.rights import rights_of
from swarm.access.zenoh_limits import limits
from swarm.access.zenoh_rules import access_control
from swarm.config.laboratory import Laboratory
from swarm.errors import UserError, nearest
from swarm.files import make_folder, write_json, write_whole

AUTHORITY = "authority"
REVOKED_FILE = "revoked.json"
ROUTER_FILE = "zenohd.json"
ALL = "all"
HERE = ("localhost", "127.0.0.1", "::1")
"""A server is reached from its own machine too."""


@dataclass(frozen=True)
class Issued:
    """What became of an identity's certificate."""

    name: str
    state: str
    """made, kept, renewed or revoked."""
    valid_until: str


class Keyring:
    """The keys of one laboratory, in a folder."""

    def __init__(self, folder: Path, laboratory: Laboratory, simulated: bool = False) -> None:
        self._folder = folder
        self._laboratory = laboratory
        self._robots = [robot.id for robot in laboratory.robot]
        self._simulated = simulated or _is_simulated(laboratory)
        self._identities = identities(self._robots)

    def update(self, renew: Collection[str], revoke: Collection[str], now: datetime) -> list[Issued]:
        """Make what is missing, renew and revoke what is named, and write the rules anew.

        "all" renews the authority too: then nobody with an older certificate is spoken with at all. Whoever
        was revoked stays so.
        """
        self._check_names(renew, revoke)
        make_folder(self._folder)
        self._folder.chmod(0o700)
        revoked = (self._revoked() | set(revoke)) - set(renew)
        if ALL in renew:
            renew = {ALL, *map(str, self._identities)}
        authority = self._authority(ALL in renew, now)
        issued = [self._issue(one, authority, renew, revoked, now) for one in self._identities]
        write_json(sorted(revoked), self._folder / REVOKED_FILE)
        self._write_rules([one for one in self._identities if str(one) not in revoked])
        return issued

    def _check_names(self, renew: Collection[str], revoke: Collection[str]) -> None:
        known = [str(one) for one in self._identities]
        for option, names in (("--renew", {*renew} - {ALL}), ("--revoke", revoke)):
            for name in names:
                if name not in known:
                    raise UserError(f"{option} {name!r} is not of this laboratory; {nearest(name, known)}")
        if str(SERVER) in revoke:
            raise UserError("--revoke server: without it nobody is served; --renew it")
        both = sorted({*renew} & {*revoke})
        if both:
            raise UserError(f"--renew and --revoke both name {', '.join(both)}: one of them is meant")

    def _revoked(self) -> set[str]:
        file = self._folder / REVOKED_FILE
        return set(json.loads(file.read_text(encoding="utf-8"))) if file.exists() else set()

    def _authority(self, renew: bool, now: datetime) -> Authority:
        folder = self._folder / AUTHORITY
        if renew or not _is_complete(folder):
            _write_signed(folder, Authority.new(self._laboratory.laboratory.name, now))
        return Authority(Signed(*((folder / name).read_bytes() for name in (CERTIFICATE_FILE, KEY_FILE))))

    def _issue(
        self,
        identity: Identity,
        authority: Authority,
        renew: Collection[str],
        revoked: Collection[str],
        now: datetime,
    ) -> Issued:
        name, folder = str(identity), self._folder / str(identity)
        if name in revoked:
            shutil.rmtree(folder, ignore_errors=True)
            return Issued(name, "revoked", "")
        hosts = [self._laboratory.server.host, *HERE]
        state = "made" if not _is_complete(folder) else "renewed" if name in renew else "kept"
        if state == "kept" and identity == SERVER and not set(hosts) <= set(hosts_of(_certificate(folder))):
            state = "renewed"
        if state != "kept":
            _write_signed(folder, authority.sign(identity, dict.fromkeys(hosts), now))
        authority_file = self._folder / AUTHORITY / CERTIFICATE_FILE
        _write_private(folder / AUTHORITY_FILE, authority_file.read_bytes())
        return Issued(name, state, valid_until(_certificate(folder)).date().isoformat())

    def _write_rules(self, known: Iterable[Identity]) -> None:
        folder = self._folder / str(SERVER)
        rules = access_control(
            {
                str(one): (
                    common_name(_certificate(self._folder / str(one))),
                    rights_of(one, self._robots, self._simulated),
                )
                for one in known
            }
        )
        write_json(rules, folder / ACCESS_FILE)
        write_json(self._router(rules), folder / ROUTER_FILE)

    def _router(self, rules: Mapping[str, Any]) -> dict[str, Any]:
        """A whole configuration for `zenohd -c zenohd.json`, started in this folder."""
        values = {
            "mode": "router",
            "listen/endpoints": [f"tls/[::]:{self._laboratory.server.port}"],
            "scouting/multicast/enabled": False,
            "scouting/gossip/enabled": False,
            "transport/shared_memory/enabled": False,
            "transport/link/tls": tls(Path(), hub=True),
            "access_control": rules,
            **limits(self._robots),
        }
        return _nested(values)


def _is_simulated(laboratory: Laboratory) -> bool:
    backend = laboratory.tracker.backend if laboratory.tracker else ""
    return "sim" in {backend, *(robot.driver for robot in laboratory.robot)}


def _certificate(folder: Path) -> bytes:
    return (folder / CERTIFICATE_FILE).read_bytes()


def _is_complete(folder: Path) -> bool:
    return all((folder / name).exists() for name in (CERTIFICATE_FILE, KEY_FILE))


def _write_signed(folder: Path, signed: Signed) -> None:
    make_folder(folder)
    _write_private(folder / KEY_FILE, signed.key)
    _write_private(folder / CERTIFICATE_FILE, signed.certificate)


def _write_private(path: Path, content: bytes) -> None:
    """A file that its owner alone can read, from its first byte on."""

    def write(temporary: Path) -> None:
        with open(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
            file.write(content)

    write_whole(path, write)


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by place as one tree."""
    tree: dict[str, Any] = {}
    for place, value in values.items():
        *groups, key = place.split("/")
        at = tree
        for group in groups:
            at = at.setdefault(group, {})
        at[key] = value
    return tree
