"""A connection that both sides' certificates will never allow is told of at once, with the reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.access.tls_check import check_certificates
from swarm.errors import UserError
from tests.support.certified import CertifiedLaboratory


@pytest.fixture
def laboratory(tmp_path: Path) -> CertifiedLaboratory:
    return CertifiedLaboratory(tmp_path)


def test_who_is_of_the_laboratory_may_connect_to_its_server(laboratory: CertifiedLaboratory) -> None:
    with laboratory.hub():
        check_certificates(laboratory.endpoint, laboratory.keys("robot-r0"))


def test_nobody_is_there_is_no_fault_of_a_certificate(laboratory: CertifiedLaboratory) -> None:
    check_certificates(laboratory.endpoint, laboratory.keys("robot-r0"))


def test_a_certificate_of_another_authority_is_told_of(
    laboratory: CertifiedLaboratory, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = CertifiedLaboratory(tmp_path_factory.mktemp("other"))
    with laboratory.hub():
        with pytest.raises(UserError, match="the server's certificate is not believed"):
            check_certificates(laboratory.endpoint, other.keys("robot-r0"))
        believing = other.keys("robot-r0")
        (believing / "authority.pem").write_bytes((laboratory.keys("viewer") / "authority.pem").read_bytes())
        with pytest.raises(UserError, match="the server refuses this certificate"):
            check_certificates(laboratory.endpoint, believing)


def test_a_server_under_another_name_is_told_of(laboratory: CertifiedLaboratory) -> None:
    """127.0.0.2 is this machine too, and not in the certificate."""
    port = laboratory.endpoint.rpartition(":")[2]
    laboratory.endpoint = f"tls/0.0.0.0:{port}"
    with laboratory.hub(), pytest.raises(UserError, match="IP address mismatch"):
        check_certificates(f"tls/127.0.0.2:{port}", laboratory.keys("robot-r0"))


def test_files_that_are_no_certificates_are_told_of(laboratory: CertifiedLaboratory) -> None:
    (laboratory.keys("robot-r0") / "key.pem").write_text("no key")
    with pytest.raises(UserError, match="its files cannot be used"):
        check_certificates(laboratory.endpoint, laboratory.keys("robot-r0"))
