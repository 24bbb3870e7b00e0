"""Keys on the disk: what is made, kept, renewed and taken away, and what the rules then list."""

from __future__ import annotations

import json
import stat
from pathlib import Path

import pytest
from cryptography import x509

from swarm.access.authority import common_name, hosts_of
from swarm.errors import UserError
from tests.support.certified import CertifiedLaboratory, laboratory_text


@pytest.fixture
def laboratory(tmp_path: Path) -> CertifiedLaboratory:
    return CertifiedLaboratory(tmp_path)


def name_of(laboratory: CertifiedLaboratory, identity: str) -> str:
    return common_name((laboratory.keys(identity) / "certificate.pem").read_bytes())


def listed(laboratory: CertifiedLaboratory) -> set[str]:
    rules = json.loads((laboratory.keys("server") / "access.json").read_text())
    return {name for subject in rules["subjects"] for name in subject["cert_common_names"]}


IDENTITIES = ("server", "tracker", "operator", "viewer", "robot-r0", "robot-r1")


def test_everyone_has_a_certificate_that_the_rules_list(laboratory: CertifiedLaboratory) -> None:
    assert listed(laboratory) == {name_of(laboratory, one) for one in IDENTITIES}
    assert len(listed(laboratory)) == len(IDENTITIES)


def test_what_is_there_is_kept(laboratory: CertifiedLaboratory) -> None:
    before = listed(laboratory)
    assert {one.state for one in laboratory.update()} == {"kept"}
    assert listed(laboratory) == before


def test_a_renewed_certificate_replaces_the_old_one_in_the_rules(laboratory: CertifiedLaboratory) -> None:
    old = name_of(laboratory, "robot-r0")
    states = {one.name: one.state for one in laboratory.update(renew=["robot-r0"])}
    assert {name for name, state in states.items() if state != "kept"} == {"robot-r0"}
    assert old not in listed(laboratory)
    assert name_of(laboratory, "robot-r0") in listed(laboratory)


def test_who_is_revoked_stays_so_until_renewed(laboratory: CertifiedLaboratory) -> None:
    old = name_of(laboratory, "robot-r1")
    laboratory.update(revoke=["robot-r1"])
    states = {one.name: one.state for one in laboratory.update()}
    assert states["robot-r1"] == "revoked"
    assert old not in listed(laboratory)
    assert not laboratory.keys("robot-r1").exists()
    assert laboratory.update(renew=["all"])[-1].state == "revoked"
    assert laboratory.update(renew=["robot-r1"])[-1].state == "made"
    assert name_of(laboratory, "robot-r1") in listed(laboratory)


def test_a_robot_that_the_laboratory_no_longer_has_is_not_listed(laboratory: CertifiedLaboratory) -> None:
    gone = name_of(laboratory, "robot-r1")
    laboratory.file.write_text(laboratory_text(["r0"]))
    laboratory.update()
    assert gone not in listed(laboratory)


def test_a_new_authority_renews_everyone(laboratory: CertifiedLaboratory) -> None:
    authority = (laboratory.keys("authority") / "certificate.pem").read_bytes()
    assert {one.state for one in laboratory.update(renew=["all"])} == {"renewed"}
    new = (laboratory.keys("authority") / "certificate.pem").read_bytes()
    assert new != authority
    for identity in IDENTITIES:
        assert (laboratory.keys(identity) / "authority.pem").read_bytes() == new
        signed = x509.load_pem_x509_certificate((laboratory.keys(identity) / "certificate.pem").read_bytes())
        signed.verify_directly_issued_by(x509.load_pem_x509_certificate(new))


def test_a_server_that_moved_gets_a_certificate_of_its_new_host(laboratory: CertifiedLaboratory) -> None:
    laboratory.file.write_text(
        laboratory.file.read_text().replace('host = "127.0.0.1"', 'host = "lab.local"', 1)
    )
    assert laboratory.update()[0].state == "renewed"
    certificate = (laboratory.keys("server") / "certificate.pem").read_bytes()
    assert list(hosts_of(certificate)) == ["lab.local", "localhost", "127.0.0.1", "::1"]


def test_keys_are_for_their_owner_alone(laboratory: CertifiedLaboratory) -> None:
    for key in laboratory.folder.rglob("*.pem"):
        assert stat.S_IMODE(key.stat().st_mode) == 0o600, key
    assert stat.S_IMODE((laboratory.folder / "keys").stat().st_mode) == 0o700


@pytest.mark.parametrize(
    ("renew", "revoke", "says"),
    [
        (["robot-r9"], [], "--renew 'robot-r9' is not of this laboratory; did you mean 'robot-r1'"),
        ([], ["viewers"], "did you mean 'viewer'"),
        ([], ["server"], "without it nobody is served"),
        (["robot-r0"], ["robot-r0"], "one of them is meant"),
    ],
)
def test_a_wrong_name_changes_nothing(
    laboratory: CertifiedLaboratory, renew: list[str], revoke: list[str], says: str
) -> None:
    before = listed(laboratory)
    with pytest.raises(UserError, match=says):
        laboratory.update(renew, revoke)
    assert listed(laboratory) == before
